// Samplers: refused where no device of the context has images.
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/memory.h"
#include "devices/layer/program.h"

namespace partita::layer {
namespace {

template <typename Create>
cl_sampler make_sampler(cl_context handle, cl_int& error, Create&& driver_create) {
  auto context = known_context(handle);
  if (context && !has_images(*context)) {
    error = CL_INVALID_OPERATION;
    return nullptr;
  }
  const cl_sampler sampler = driver_create(error);
  if (!sampler || !context) return sampler;
  const Lock lock(state().mutex);
  state().samplers.add(sampler, std::make_shared<Sampler>(std::move(context)));
  return sampler;
}

cl_sampler CL_API_CALL create_sampler(cl_context handle, cl_bool normalized,
                                      cl_addressing_mode addressing, cl_filter_mode filter,
                                      cl_int* errcode_ret) {
  return guarded_object<cl_sampler>(errcode_ret, [&](cl_int& error) {
    return make_sampler(handle, error, [&](cl_int& e) {
      return target().clCreateSampler(handle, normalized, addressing, filter, &e);
    });
  });
}

cl_sampler CL_API_CALL create_sampler_with_properties(cl_context handle,
                                                      const cl_sampler_properties* properties,
                                                      cl_int* errcode_ret) {
  return guarded_object<cl_sampler>(errcode_ret, [&](cl_int& error) {
    return make_sampler(handle, error, [&](cl_int& e) {
      return target().clCreateSamplerWithProperties(handle, properties, &e);
    });
  });
}

cl_int CL_API_CALL retain_sampler(cl_sampler handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainSampler(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().samplers.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_sampler(cl_sampler handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      state().samplers.release(handle);
    }
    return target().clReleaseSampler(handle);
  });
}

}  // namespace

void add_sampler_calls(cl_icd_dispatch& table) {
  table.clCreateSampler = create_sampler;
  table.clCreateSamplerWithProperties = create_sampler_with_properties;
  table.clRetainSampler = retain_sampler;
  table.clReleaseSampler = release_sampler;
}

}  // namespace partita::layer
