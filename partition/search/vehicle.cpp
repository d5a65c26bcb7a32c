#include "partition/search/vehicle.h"

#include <cmath>
#include <string>

#include "devices/profile/error.h"

namespace partita::partition {
namespace {

void check_positive(const char* what, double value, const char* unit) {
  if (value > 0 && std::isfinite(value)) return;
  throw profile::Error(std::string("vehicle: ") + what + " of " + std::to_string(value) + " " +
                       unit + ", expected more than 0");
}

}  // namespace

double added_stopping_distance_m(const Vehicle& vehicle, double latency_ns) {
  return vehicle.speed_mps * latency_ns * 1e-9;
}

double driving_hours(const Vehicle& vehicle, double computer_w) {
  return vehicle.battery_wh / (vehicle.base_power_w + computer_w);
}

void check(const Vehicle& vehicle) {
  check_positive("a speed", vehicle.speed_mps, "m/s");
  check_positive("a battery", vehicle.battery_wh, "Wh");
  check_positive("a base power", vehicle.base_power_w, "W");
}

}  // namespace partita::partition
