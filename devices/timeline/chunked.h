// A vector whose elements never move: it grows by small chunks, so that no command pays for copying
// all earlier ones. Inside the timeline only.
#ifndef PARTITA_DEVICES_TIMELINE_CHUNKED_H
#define PARTITA_DEVICES_TIMELINE_CHUNKED_H

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace partita::timeline {

template <class T>
class Chunked {
 public:
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const T& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }
  T& push_back(T value) {
    if (size_ % kChunk == 0) chunks_.push_back(std::make_unique<T[]>(kChunk));
    return (*this)[size_++] = std::move(value);
  }
  void clear() {
    chunks_.clear();
    size_ = 0;
  }

 private:
  static constexpr std::size_t kChunk = 256;
  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_CHUNKED_H
