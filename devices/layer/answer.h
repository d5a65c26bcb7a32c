// How a query answers: the rules of OpenCL's clGet*Info about value, size and size_ret, once.
#ifndef PARTITA_DEVICES_LAYER_ANSWER_H
#define PARTITA_DEVICES_LAYER_ANSWER_H

#include <cstddef>
#include <cstring>
#include <string_view>
#include <vector>

#include <CL/cl.h>

namespace partita::layer {

/// The last three arguments of a query. Each put_* returns the query's result: CL_INVALID_VALUE if
/// the caller's memory is too small, and then nothing is written.
class Answer {
 public:
  Answer(std::size_t size, void* value, std::size_t* size_ret)
      : size_(size), value_(value), size_ret_(size_ret) {}

  cl_int put_bytes(const void* data, std::size_t bytes) const {
    if (value_ && size_ < bytes) return CL_INVALID_VALUE;
    if (value_ && bytes) std::memcpy(value_, data, bytes);
    if (size_ret_) *size_ret_ = bytes;
    return CL_SUCCESS;
  }
  template <typename T>
  cl_int put(const T& v) const {
    return put_bytes(&v, sizeof v);
  }
  /// With its terminating zero.
  cl_int put_text(std::string_view text) const {
    if (value_ && size_ < text.size() + 1) return CL_INVALID_VALUE;
    if (value_) {
      std::memcpy(value_, text.data(), text.size());
      static_cast<char*>(value_)[text.size()] = 0;
    }
    if (size_ret_) *size_ret_ = text.size() + 1;
    return CL_SUCCESS;
  }
  template <typename T>
  cl_int put_list(const std::vector<T>& list) const {
    return put_bytes(list.data(), list.size() * sizeof(T));
  }

  std::size_t size() const { return size_; }
  void* value() const { return value_; }
  std::size_t* size_ret() const { return size_ret_; }

 private:
  std::size_t size_;
  void* value_;
  std::size_t* size_ret_;
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_ANSWER_H
