// Messages: what passes between tasks, and from the sensors to them: sent to a node when it was
// posted, once, whoever waits for it there. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_MESSAGES_H
#define PARTITA_PARTITION_SIMULATE_MESSAGES_H

#include <vector>

#include "partition/simulate/driver.h"

namespace partita::partition {

class Messages {
 public:
  explicit Messages(const Compiler& compiler)
      : compiler_(compiler), networks_(compiler.layout(), nullptr) {}

  void reset(const Scene& scene);
  /// When the task's input of a frame is on its node; of the sensors', or of input `input`.
  Ns sensor(std::uint32_t task, std::size_t frame);
  Ns message(std::uint32_t task, std::uint32_t input, std::size_t frame);
  void post(std::uint32_t task, std::size_t frame, Ns time) {
    posts_[task * scene_->frames + frame] = time;
  }
  /// See repetition.h.
  bool idle(Ns at) const { return networks_.save(at).words.empty(); }
  void save(Ns at, std::size_t first, std::size_t last, std::vector<Ns>& words) const;
  void forward(Ns time, std::size_t frames, std::size_t first, std::size_t last);
  /// Links between nodes.
  const timeline::Placement& calendars() const { return networks_; }
  const std::vector<std::uint64_t>& link_bytes() const { return link_bytes_; }

 private:
  Ns earliest_post(Ns at, std::size_t first, std::size_t last) const;
  Ns deliver(std::uint32_t task, std::uint32_t channel, std::size_t frame, std::uint32_t home,
             Ns posted);

  const Compiler& compiler_;
  timeline::Placement networks_;
  const Scene* scene_ = nullptr;
  std::vector<Ns> posts_;      ///< by task and frame
  std::vector<Ns> delivered_;  ///< by channel, node and frame; kNot: not sent yet
  std::vector<std::uint64_t> link_bytes_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_MESSAGES_H
