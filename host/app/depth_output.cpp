#include "host/app/depth_output.h"

#include <fmt/format.h>

#include "host/io/image.h"

namespace partita::app {
namespace {

constexpr std::size_t kMaxQueued = 8;

}  // namespace

sensing::FloatImage to_pixels(const depth::DisparityMap& map) {
  sensing::FloatImage image(map.width, map.height);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    image.pixels[i] = static_cast<float>(map.values[i]) / 256.0f;
  }
  return image;
}

DepthOutput::DepthOutput(std::string folder)
    : folder_(std::move(folder)), thread_([this] { work(); }) {}

DepthOutput::~DepthOutput() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DepthOutput::add(std::shared_ptr<const sensing::Frame> frame, depth::DisparityMap map) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return queue_.size() < kMaxQueued || error_; });
  if (error_) std::rethrow_exception(error_);
  queue_.push_back({std::move(frame), std::move(map)});
  changed_.notify_all();
}

DepthAccuracy DepthOutput::finish() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(error_);
  if (accuracy_.frames > 0)
    accuracy_.density = density_sum_ / static_cast<double>(accuracy_.frames);
  return accuracy_;
}

void DepthOutput::work() {
  for (;;) {
    Item item;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !queue_.empty() || closed_; });
      if (queue_.empty()) return;
      item = std::move(queue_.front());
      queue_.pop_front();
    }
    changed_.notify_all();
    try {
      const sensing::FloatImage disparity = to_pixels(item.map);
      io::write_disparity(fmt::format("{}/{:06}.png", folder_, item.frame->index), disparity);
      account(item, disparity);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      error_ = std::current_exception();
      queue_.clear();
      changed_.notify_all();
      return;
    }
  }
}

void DepthOutput::account(const Item& item, const sensing::FloatImage& disparity) {
  ++accuracy_.frames;
  density_sum_ += item.map.density();
  accuracy_.frames_without_support += item.map.too_few_support_points ? 1 : 0;
  if (const auto& truth = item.frame->disparity) {
    accuracy_.evaluation += depth::evaluate(disparity, *truth);
  }
  if (first_map_) return;
  first_map_ = item.map;
  first_frame_ = item.frame;
}

}  // namespace partita::app
