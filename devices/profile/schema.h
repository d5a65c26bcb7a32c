// The schema of a device profile's sections. Inside the profile library only.
#ifndef PARTITA_DEVICES_PROFILE_SCHEMA_H
#define PARTITA_DEVICES_PROFILE_SCHEMA_H

#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "devices/profile/reader.h"

namespace partita::profile {

inline constexpr std::array<std::string_view, kOpClasses> kOpClassNames{
    "int_add",       "int_mul",    "int_special", "float_add",  "float_mul",      "float_fma",
    "float_special", "double_add", "double_mul",  "double_fma", "double_special", "atomic"};
inline constexpr std::array<std::string_view, kWorkKinds> kWorkKindNames{
    "stream", "stencil", "gather", "dense", "reduce", "serial"};

/// One key of a section: where its value goes, and for a number its unit and range.
template <class T>
struct Field {
  const char* key;
  std::variant<std::string T::*, bool T::*, double T::*, std::uint64_t T::*, std::uint32_t T::*>
      target;
  Range range = {};
};

/// Reads every field; `extra` are keys of the section that the caller reads itself.
template <class T>
void read_fields(const Reader& reader, std::span<const Field<T>> fields, T& to,
                 std::vector<std::string_view> extra = {}) {
  for (const auto& field : fields) extra.push_back(field.key);
  reader.allow(extra);
  for (const auto& field : fields) {
    std::visit(
        [&](auto member) {
          using Value = std::remove_reference_t<decltype(to.*member)>;
          if constexpr (std::is_same_v<Value, std::string>) {
            to.*member = reader.text(field.key);
          } else if constexpr (std::is_same_v<Value, bool>) {
            to.*member = reader.flag(field.key);
          } else if constexpr (std::is_same_v<Value, double>) {
            to.*member = reader.number(field.key, field.range);
          } else {
            to.*member = static_cast<Value>(reader.integer(field.key, field.range));
          }
        },
        field.target);
  }
}

/// The optional key `uncertainty` of a device or a link.
std::optional<double> read_uncertainty(const Reader& reader);
void read_opencl(const Reader& reader, OpenclIdentity& to);
void read_performance(const Reader& reader, DeviceType type, Performance& to);
void read_host(const Reader& reader, HostCosts& to);
void read_link(const Reader& reader, HostLink& to);
void read_power(const Reader& reader, Power& to);
void read_fabric(const Reader& reader, Fabric& to);

}  // namespace partita::profile

#endif  // PARTITA_DEVICES_PROFILE_SCHEMA_H
