// Side tables: what the layer knows about the driver's own handles, which it does not wrap.
#ifndef PARTITA_DEVICES_LAYER_REGISTRY_H
#define PARTITA_DEVICES_LAYER_REGISTRY_H

#include <cstdint>
#include <memory>
#include <unordered_map>

namespace partita::layer {

/// An entry lives as long as the program holds a reference to the handle, or another entry (a
/// kernel, of its program) needs it: the handle is found that long, as OpenCL lets a program ask a
/// kernel for its released program. A handle that the driver gives out again replaces the old
/// entry. Not thread-safe: the state's mutex is held.
template <typename Handle, typename Entry>
class Registry {
 public:
  void add(Handle handle, std::shared_ptr<Entry> entry) { slots_[handle] = Slot{entry, entry, 1}; }
  /// Null for a handle that is not the program's, or no longer.
  std::shared_ptr<Entry> find(Handle handle) {
    const auto it = slots_.find(handle);
    if (it == slots_.end()) return nullptr;
    if (it->second.held) return it->second.held;
    std::shared_ptr<Entry> entry = it->second.any.lock();
    if (!entry) slots_.erase(it);
    return entry;
  }
  /// Whether find() would have it.
  bool has(Handle handle) const {
    const auto it = slots_.find(handle);
    return it != slots_.end() && !it->second.any.expired();
  }
  void retain(Handle handle) {
    const auto it = slots_.find(handle);
    if (it == slots_.end()) return;
    if (!it->second.held) it->second.held = it->second.any.lock();
    ++it->second.references;
  }
  /// The entry whose last reference this was, else null.
  std::shared_ptr<Entry> release(Handle handle) {
    const auto it = slots_.find(handle);
    if (it == slots_.end() || it->second.references == 0) return nullptr;
    if (--it->second.references != 0) return nullptr;
    std::shared_ptr<Entry> last = std::move(it->second.held);
    it->second.held.reset();
    if (last.use_count() == 1) slots_.erase(it);
    return last;
  }
  /// Entries that are alive.
  std::size_t size() {
    sweep();
    return slots_.size();
  }

 private:
  struct Slot {
    std::shared_ptr<Entry> held;  ///< while the program has references
    std::weak_ptr<Entry> any;
    std::uint32_t references = 0;
  };
  /// Forgets handles whose entries another entry was the last to need.
  void sweep() {
    std::erase_if(slots_, [](const auto& slot) { return slot.second.any.expired(); });
  }

  std::unordered_map<Handle, Slot> slots_;
  std::size_t sweep_at_ = 64;
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_REGISTRY_H
