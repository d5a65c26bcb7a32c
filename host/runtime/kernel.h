// Kernel: a spec bound to a session. launch() checks the arguments against the spec, declares the
// Work and enqueues. Argument values: cl::Buffer, numbers (of exactly the declared width), Local.
#ifndef PARTITA_HOST_RUNTIME_KERNEL_H
#define PARTITA_HOST_RUNTIME_KERNEL_H

#include <cstddef>
#include <type_traits>

#include "host/runtime/session.h"

namespace partita::runtime {

/// Size of a __local argument.
struct Local {
  std::size_t bytes = 0;
};

class Kernel {
 public:
  Kernel(const Session& session, const KernelSpec& spec)
      : session_(&session), spec_(&spec), kernel_(session.make_kernel(spec)) {}

  /// Enqueues one launch on the session's queue. `shape` decides geometry and Work.
  template <typename... Args>
  void launch(const Shape& shape, const Args&... args) {
    check_count(sizeof...(args));
    cl_uint index = 0;
    (set(index++, args), ...);
    enqueue(shape);
  }

  /// For launches whose arguments are only known as KernelCase values (checker.h).
  void set_raw(cl_uint index, std::size_t size, const void* value);
  void enqueue(const Shape& shape);
  const KernelSpec& spec() const { return *spec_; }

 private:
  void check_count(std::size_t count) const;
  void check_scalar(cl_uint index, std::size_t size) const;
  void set(cl_uint index, const cl::Buffer& buffer) {
    const cl_mem memory = buffer();
    set_raw(index, sizeof memory, &memory);
  }
  void set(cl_uint index, Local local) { set_raw(index, local.bytes, nullptr); }
  template <typename T>
  requires std::is_arithmetic_v<T>
  void set(cl_uint index, const T& value) {
    check_scalar(index, sizeof value);
    set_raw(index, sizeof value, &value);
  }

  const Session* session_;
  const KernelSpec* spec_;
  cl::Kernel kernel_;
};

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_KERNEL_H
