// Objective and Score: the figures that placements are compared by.
#ifndef PARTITA_PARTITION_SEARCH_OBJECTIVE_H
#define PARTITA_PARTITION_SEARCH_OBJECTIVE_H

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace partita::partition {

enum class Objective : std::uint8_t {
  latency,     ///< p99 of the end-to-end latency, ns: least
  energy,      ///< per frame, J: least
  throughput,  ///< finished frames per second, Hz: most
  cost,        ///< of the parts used, USD: least
};
inline constexpr std::array kObjectives{Objective::latency, Objective::energy,
                                        Objective::throughput, Objective::cost};
std::string_view to_string(Objective objective);
/// Throws profile::Error that lists what there is.
Objective parse_objective(std::string_view text);

/// All predicted, but for the price.
struct Score {
  /// Share of the tasks' frames that they did not do, 0..1: their queues were full.
  double dropped = 0;
  double p50_ns = 0, p99_ns = 0;  ///< end-to-end latency
  double energy_j = 0;            ///< per frame
  /// Between two finished frames in the long run, 1e9 / throughput. A finite run may seem faster
  /// than its steady state, where its first frame is late and its last one is not: what the cameras
  /// and the loads of the engines do not allow is cut off.
  double frame_ns = 0;
  /// Share of the scarcest resource of the fullest FPGA; 0: none used; above 1: by swapping.
  double area = 0;
  double price_usd = 0;
  double power_w = 0;  ///< mean

  double throughput_hz() const { return 1e9 / frame_ns; }
  bool operator==(const Score&) const = default;
};

/// The objective's figure, in its own unit: ns, J, Hz, USD.
double value(Objective objective, const Score& score);
/// The same as something that less of is better: of throughput, ns per frame.
double cost(Objective objective, const Score& score);
/// Turns a cost() into a value() and the other way round.
double convert(Objective objective, double cost);

/// "52.41 ms", "1.960 J", "9.90 Hz", "2495 USD".
std::string show(Objective objective, double value);

/// Whether `a` ranks before `b`: whatever drops less, since leaving out work is a way to save time
/// and energy that nobody asks for; then by the objective; then, where that is exactly equal, by
/// latency p99, energy, price, p50. Neither does if all are equal: the caller keeps placement
/// order.
bool ranks_before(Objective objective, const Score& a, const Score& b);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_OBJECTIVE_H
