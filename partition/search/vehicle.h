// Vehicle: what latency and power mean on the road.
#ifndef PARTITA_PARTITION_SEARCH_VEHICLE_H
#define PARTITA_PARTITION_SEARCH_VEHICLE_H

namespace partita::partition {

/// A small low-speed vehicle. The defaults are assumptions of the order that Yu et al. (MICRO 2020,
/// "Building the Computing System for Autonomous Micromobility Vehicles") give for theirs.
struct Vehicle {
  double speed_mps = 5.6;    ///< 20 km/h
  double battery_wh = 6000;  ///< assumption
  double base_power_w =
      600;  ///< assumption: drive train and all but the computer, mean while driving
};

/// Metres driven between a frame's trigger and the answer to it: speed x latency. They add to the
/// braking distance, which no computer shortens.
double added_stopping_distance_m(const Vehicle& vehicle, double latency_ns);

/// battery / (base power + the computer's)
double driving_hours(const Vehicle& vehicle, double computer_w);

/// Throws profile::Error for what no vehicle has: a speed, battery or power that is not positive.
void check(const Vehicle& vehicle);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_VEHICLE_H
