#include "devices/layer/program_text.h"

#include <algorithm>

#include "devices/layer/device_info.h"
#include "devices/layer/version.h"

namespace partita::layer {
namespace {

bool all_have(const std::vector<Device*>& devices, const std::string& extension) {
  return std::all_of(devices.begin(), devices.end(),
                     [&](const Device* d) { return d->has(extension); });
}

bool all_have_feature(const std::vector<Device*>& devices, const std::string& feature) {
  return std::all_of(devices.begin(), devices.end(), [&](const Device* d) {
    const auto features = c_features(*d);
    return std::find(features.begin(), features.end(), feature) != features.end();
  });
}

/// Extensions and OpenCL C 3.0 features for which the driver's compiler defines macros.
std::vector<std::string> driver_extensions() {
  std::size_t bytes = 0;
  target().clGetDeviceInfo(state().real_device, CL_DEVICE_EXTENSIONS, 0, nullptr, &bytes);
  std::string text(bytes, '\0');
  target().clGetDeviceInfo(state().real_device, CL_DEVICE_EXTENSIONS, bytes, text.data(), nullptr);
  return split_words(text.c_str());
}

/// Extensions that the compiler announces on its own account for OpenCL C 3.0.
std::vector<std::string> compiler_extensions() {
  return {"cl_khr_depth_images",    "cl_khr_mipmap_image",      "cl_khr_mipmap_image_writes",
          "cl_khr_gl_msaa_sharing", "cl_khr_srgb_image_writes", "cl_khr_subgroups"};
}

std::vector<std::string> driver_features() {
  std::size_t bytes = 0;
  target().clGetDeviceInfo(state().real_device, CL_DEVICE_OPENCL_C_FEATURES, 0, nullptr, &bytes);
  std::vector<cl_name_version> list(bytes / sizeof(cl_name_version));
  target().clGetDeviceInfo(state().real_device, CL_DEVICE_OPENCL_C_FEATURES,
                           list.size() * sizeof(cl_name_version), list.data(), nullptr);
  std::vector<std::string> names;
  for (const cl_name_version& f : list) names.emplace_back(f.name);
  return names;
}

void forbid_doubles(std::string& text) {
  for (const char* stem : {"", "convert_", "as_"}) {
    for (const char* width : {"", "2", "3", "4", "8", "16"}) {
      const std::string name = std::string(stem) + "double" + width;
      text += "#undef " + name + "\n#define " + name + " " + name +
              "_is_not_supported_by_this_device\n";
    }
  }
}

bool doubles(const std::vector<Device*>& devices) {
  return std::all_of(devices.begin(), devices.end(),
                     [](const Device* d) { return d->cl.doubles(); });
}

std::string version_name(cl_version v) {
  return std::to_string(CL_VERSION_MAJOR(v)) + "." + std::to_string(CL_VERSION_MINOR(v));
}

/// Whether all devices compile the version; every one compiles up to 1.2 (XRT reports 1.0, and its
/// compiler takes 1.2).
bool compiles(const std::vector<Device*>& devices, cl_version version) {
  return std::all_of(devices.begin(), devices.end(), [&](const Device* d) {
    const auto versions = c_versions(*d);
    return version <= CL_MAKE_VERSION(1, 2, 0) ||
           std::find(versions.begin(), versions.end(), version) != versions.end();
  });
}

}  // namespace

std::string prelude(const std::vector<Device*>& devices) {
  std::string text;
  for (const std::string& e : driver_extensions()) {
    if (!all_have(devices, e)) text += "#undef " + e + "\n";
  }
  for (const std::string& e : compiler_extensions()) {
    if (!all_have(devices, e)) text += "#undef " + e + "\n";
  }
  for (const std::string& f : driver_features()) {
    if (!all_have_feature(devices, f)) text += "#undef " + f + "\n";
  }
  cl_version version = CL_MAKE_VERSION(3, 0, 0);
  bool images = true, embedded = false;
  for (const Device* d : devices) {
    version = std::min(version, d->version);
    images = images && d->cl.image_support;
    embedded = embedded || d->cl.device_profile == "EMBEDDED_PROFILE";
    for (const std::string& e : d->extensions) {
      if (e.rfind("cl_nv_", 0) == 0) text += "#undef " + e + "\n#define " + e + " 1\n";
    }
  }
  text += "#undef __OPENCL_VERSION__\n#define __OPENCL_VERSION__ " +
          std::to_string(CL_VERSION_MAJOR(version) * 100 + CL_VERSION_MINOR(version) * 10) + "\n";
  if (!images) text += "#undef __IMAGE_SUPPORT__\n";
  if (embedded) text += "#define __EMBEDDED_PROFILE__ 1\n";
  if (!doubles(devices)) forbid_doubles(text);
  return text + "#line 1\n";
}

BuildOptions build_options(const char* options, const std::vector<Device*>& devices) {
  BuildOptions result;
  const bool nvidia = all_have(devices, "cl_nv_compiler_options");
  bool names_version = false;
  std::string text = options ? options : "";
  for (const std::string& word : split_words(options ? options : "")) {
    if (word.rfind("-cl-std=CL", 0) == 0) {
      names_version = true;
      const cl_version asked = parse_version(word, "-cl-std=CL");
      if (!compiles(devices, asked)) {
        result.refusal = word + ": the device " + devices[0]->cl.device_name + " compiles " +
                         devices[0]->cl.c_version + ", not OpenCL C " + version_name(asked) + "\n";
      }
    }
    if (word == "-cl-kernel-arg-info") result.keeps_arg_info = true;
    if (nvidia && word.rfind("-cl-nv-", 0) == 0) {  // register counts and such
      text.erase(text.find(word), word.size());
    }
  }
  result.text = text + " ";
  if (!names_version) result.text += "-cl-std=CL1.2 ";
  if (!result.keeps_arg_info) result.text += "-cl-kernel-arg-info ";
  if (!doubles(devices)) result.text += "-cl-single-precision-constant ";
  return result;
}

}  // namespace partita::layer
