// Known: what has been worked out, by its hash. The simulator asks it hundreds of times for every
// placement, mostly with success, which takes one look into a flat table and one at the answer.
// Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_KNOWN_H
#define PARTITA_PARTITION_SIMULATE_KNOWN_H

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

namespace partita::partition {

/// Both numbers, and each bit of them, matter for all bits of the result.
inline std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15u;
  return hash ^ (hash >> 29);
}
inline std::uint64_t mixed(std::uint64_t hash, const void* address) {
  return mixed(hash, reinterpret_cast<std::uintptr_t>(address));
}

/// Values stay where they are until clear().
template <typename Value>
class Known {
 public:
  /// The value of that hash for which is(value); null: there is none.
  template <typename Is>
  Value* find(std::uint64_t hash, const Is& is) const {
    for (std::size_t i = hash & mask(); slots_[i].value != nullptr; i = (i + 1) & mask()) {
      if (slots_[i].hash == hash && is(*slots_[i].value)) return slots_[i].value;
    }
    return nullptr;
  }
  Value& add(std::uint64_t hash, Value value) {
    if (2 * values_.size() >= slots_.size()) grow();
    values_.push_back(std::move(value));
    insert({hash, &values_.back()});
    return values_.back();
  }
  void clear() {
    values_.clear();
    slots_.assign(kFewest, {});
  }

 private:
  struct Slot {
    std::uint64_t hash = 0;
    Value* value = nullptr;
  };
  static constexpr std::size_t kFewest = 1024;

  std::size_t mask() const { return slots_.size() - 1; }
  void insert(Slot slot) {
    std::size_t i = slot.hash & mask();
    while (slots_[i].value != nullptr) i = (i + 1) & mask();
    slots_[i] = slot;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.value != nullptr) insert(slot);
    }
  }

  std::vector<Slot> slots_ = std::vector<Slot>(kFewest);  ///< at least half of them empty
  std::deque<Value> values_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_KNOWN_H
