// What the predicted clock does in small programs whose times can be worked out by hand.
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/devices/timeline_programs.h"

namespace partita::timeline::test {
namespace {

constexpr DeviceId kGpu0 = 0, kFpga = 2, kGpu1 = 3, kCpu1 = 4;  // of small_layout

/// A kernel of `ns` on a device; small_layout's costs: gpu1 has api 80, submit 90, wake-up 100.
Command kernel(QueueId queue, Ns ns, std::span<const NodeId> waits = {}) {
  Command c;
  c.queue = queue;
  c.demand.compute_ns = ns;
  c.waits = waits;
  return c;
}

struct TimelineTest : ::testing::Test {
  Timeline timeline{small_layout()};
  ThreadId thread = timeline.add_thread("main");
  QueueId in_order = timeline.add_queue(kGpu1, false);
  QueueId out_of_order = timeline.add_queue(kGpu1, true);
  NodeId enqueue(const Command& c) { return timeline.enqueue(thread, c); }
  void SetUp() override { timeline.bind_thread(thread, "main", 0, kGpu1); }
};

TEST_F(TimelineTest, OneKernel) {
  const NodeId k = enqueue(kernel(in_order, 1000));
  EXPECT_EQ(timeline.times(k), (Times{80, 170, 170, 1170}));
  EXPECT_EQ(timeline.clock(thread), 80u);
  EXPECT_TRUE(timeline.finish(thread, in_order));
  EXPECT_EQ(timeline.clock(thread), 1270u);  // END + wake-up
  EXPECT_TRUE(timeline.finish(thread, in_order));
  EXPECT_EQ(timeline.clock(thread), 1350u);  // nothing to wait for: only the call
}

TEST_F(TimelineTest, InOrderQueueIsSerialAndOneEngineServesBothQueues) {
  const NodeId a = enqueue(kernel(in_order, 1000));
  const NodeId b = enqueue(kernel(in_order, 500));
  const NodeId c = enqueue(kernel(out_of_order, 300));
  EXPECT_EQ(timeline.times(b).start, timeline.times(a).end);
  EXPECT_EQ(timeline.times(c).start, timeline.times(b).end);
}

TEST_F(TimelineTest, AReadyCommandFillsTheGapBeforeABlockedOne) {
  const NodeId copy = [&] {
    Command c;
    c.queue = out_of_order;
    c.kind = CommandKind::write;
    c.bytes = 900'000;  // 100 us at 9 GB/s
    return enqueue(c);
  }();
  const NodeId blocked = enqueue(kernel(out_of_order, 1000, {&copy, 1}));
  const NodeId ready = enqueue(kernel(out_of_order, 2000));
  EXPECT_EQ(timeline.times(copy).end - timeline.times(copy).start, 100'600u);
  EXPECT_EQ(timeline.times(blocked).start, timeline.times(copy).end);
  EXPECT_LT(timeline.times(ready).end, timeline.times(blocked).start);
  const NodeId large = enqueue(kernel(out_of_order, 200'000));
  EXPECT_EQ(timeline.times(large).start, timeline.times(blocked).end);
}

TEST_F(TimelineTest, BarrierHoldsLaterCommandsBackAndAMarkerDoesNot) {
  const NodeId k = enqueue(kernel(out_of_order, 5000));
  Command marker;
  marker.queue = out_of_order;
  marker.kind = CommandKind::marker;
  const NodeId m = enqueue(marker);
  EXPECT_EQ(timeline.times(m).start, timeline.times(k).end);
  Command write;
  write.queue = out_of_order;
  write.kind = CommandKind::write;
  write.bytes = 9000;
  const NodeId free = enqueue(write);
  EXPECT_LT(timeline.times(free).start, timeline.times(k).end);
  marker.kind = CommandKind::barrier;
  const NodeId b = enqueue(marker);
  write.kind = CommandKind::read;
  const NodeId held = enqueue(write);
  EXPECT_GE(timeline.times(held).start, timeline.times(b).end);
  EXPECT_EQ(timeline.times(b).end, timeline.times(k).end);
}

TEST_F(TimelineTest, AMarkerWithAListWaitsForTheListAlone) {
  const NodeId brief = enqueue(kernel(out_of_order, 100));
  enqueue(kernel(out_of_order, 90'000));
  Command marker;
  marker.queue = out_of_order;
  marker.kind = CommandKind::marker;
  marker.waits = {&brief, 1};
  const NodeId m = enqueue(marker);
  EXPECT_LT(timeline.times(m).end, 1000u);
}

TEST_F(TimelineTest, UserEventHoldsCommandsUntilItIsSet) {
  const NodeId event = timeline.create_user_event(thread);
  const NodeId k = enqueue(kernel(out_of_order, 1000, {&event, 1}));
  const NodeId after = enqueue(kernel(out_of_order, 10, {&k, 1}));
  const NodeId other = enqueue(kernel(out_of_order, 50));
  EXPECT_TRUE(timeline.resolved(other));
  EXPECT_FALSE(timeline.resolved(k));
  EXPECT_THROW(timeline.times(k), profile::Error);
  EXPECT_FALSE(timeline.wait(thread, {&k, 1}));
  EXPECT_FALSE(timeline.finish(thread, out_of_order));
  timeline.wait_until(thread, 50'000);
  EXPECT_TRUE(timeline.set_user_event(thread, event, 0));
  EXPECT_FALSE(timeline.set_user_event(thread, event, 0));
  EXPECT_EQ(timeline.times(event).end, 50'000u);
  EXPECT_EQ(timeline.times(k).start, 50'000u);
  EXPECT_EQ(timeline.times(after).start, timeline.times(k).end);
}

TEST_F(TimelineTest, AFailedUserEventTerminatesWhatListsIt) {
  const NodeId event = timeline.create_user_event(thread);
  const NodeId k = enqueue(kernel(out_of_order, 1000, {&event, 1}));
  const NodeId next = enqueue(kernel(out_of_order, 1000, {&k, 1}));
  timeline.set_user_event(thread, event, -7);
  EXPECT_EQ(timeline.status(event), -7);
  EXPECT_EQ(timeline.status(k), -14);
  EXPECT_EQ(timeline.status(next), -14);
  EXPECT_EQ(timeline.times(k).start, timeline.times(k).end);
  const NodeId late = enqueue(kernel(out_of_order, 10, {&next, 1}));
  EXPECT_EQ(timeline.status(late), -14);
}

TEST_F(TimelineTest, PendingCommandsOfAnInOrderQueueKeepTheirOrder) {
  const NodeId event = timeline.create_user_event(thread);
  const NodeId first = enqueue(kernel(in_order, 1000, {&event, 1}));
  const NodeId second = enqueue(kernel(in_order, 10));
  EXPECT_FALSE(timeline.resolved(second));
  timeline.set_user_event(thread, event, -1);
  EXPECT_EQ(timeline.status(first), -14);
  EXPECT_EQ(timeline.status(second), 0);  // the queue's order is no wait list
  EXPECT_GE(timeline.times(second).start, timeline.times(first).end);
}

TEST_F(TimelineTest, HostStepsUseTheNodesCoresAndKernelsShareThem) {
  const QueueId cpu = timeline.add_queue(kCpu1, true);
  Demand step;
  step.compute_ns = 10'000;
  const NodeId s = timeline.host_step(thread, 0, step);
  EXPECT_EQ(timeline.times(s), (Times{0, 0, 0, 10'000}));
  EXPECT_EQ(timeline.clock(thread), 10'000u);
  Command c = kernel(cpu, 3000);
  c.demand.units = 3;
  const NodeId all = enqueue(c);  // alone on three cores
  EXPECT_EQ(timeline.times(all).end - timeline.times(all).start, 3000u);
  const ThreadId other = timeline.add_thread("other");
  timeline.bind_thread(other, "other", 1, kGpu1);
  const NodeId early = timeline.enqueue(other, c);  // at 50 ns, while the step holds one core
  EXPECT_EQ(timeline.times(early).end - timeline.times(early).start, 4500u);  // two cores
}

TEST_F(TimelineTest, CircuitsRunSideBySideAndShareTheirMemory) {
  const QueueId queue = timeline.add_queue(kFpga, true);
  Command c;
  c.queue = queue;
  c.demand.memory_ns = 10'000;
  c.demand.bytes = 90'000;  // 9 of 12 GB/s
  c.name = timeline.intern("first");
  const NodeId a = enqueue(c);
  c.name = timeline.intern("second");
  const NodeId b = enqueue(c);
  const NodeId again = enqueue(c);
  const Times ta = timeline.times(a), tb = timeline.times(b);
  EXPECT_EQ(ta.end - ta.start, 10'000u);
  EXPECT_LT(tb.start, ta.end);
  EXPECT_GT(tb.end, ta.end);
  EXPECT_GT(tb.end - tb.start, 16'000u);
  EXPECT_GE(timeline.times(again).start, tb.end);
}

TEST_F(TimelineTest, LoadingWaitsForAllCircuitsAndHoldsNewOnesBack) {
  const QueueId queue = timeline.add_queue(kFpga, true);
  Command c = kernel(queue, 5000);
  c.name = timeline.intern("old");
  const NodeId old = enqueue(c);
  Command load = kernel(queue, 100'000);
  load.kind = CommandKind::load;
  const NodeId l = enqueue(load);
  c.name = timeline.intern("new");
  const NodeId fresh = enqueue(c);
  EXPECT_EQ(timeline.times(l).start, timeline.times(old).end);
  EXPECT_GE(timeline.times(fresh).start, timeline.times(l).end);
}

TEST_F(TimelineTest, CopiesAcrossNodesTakeTwoHops) {
  ThreadId soc = timeline.add_thread("soc");
  timeline.bind_thread(soc, "soc", 1, kGpu0);
  Command c;
  c.queue = timeline.add_queue(kGpu1, false);
  c.kind = CommandKind::write;
  c.bytes = 100'000;
  const NodeId remote = timeline.enqueue(soc, c);
  const Ns network = 5000 + 1'000'000, local = 600 + 11'112;
  EXPECT_EQ(timeline.times(remote).end - timeline.times(remote).start, network + local);
  EXPECT_EQ(timeline.times(remote).submit - timeline.times(remote).queued, 90u + 5000u);
  const NodeId sensor = timeline.sensor_input(soc, 0, 1'000'000);
  EXPECT_EQ(timeline.times(sensor).start, timeline.times(sensor).end);  // same node
}

TEST_F(TimelineTest, AFramesSensorDataTravelToANodeOnce) {
  const ThreadId first = timeline.add_thread("first"), second = timeline.add_thread("second");
  timeline.bind_thread(first, "first", 1, kGpu1);
  timeline.bind_thread(second, "second", 2, kGpu1);
  for (const ThreadId t : {first, second}) timeline.set_label(t, 0, 7);
  const Times one = timeline.times(timeline.sensor_input(first, 0, 1'000'000));
  const Times same = timeline.times(timeline.sensor_input(second, 0, 1'000'000));
  EXPECT_EQ(same.end, one.end);
  timeline.set_label(second, 0, 8);  // the next frame's data are others
  const Times next = timeline.times(timeline.sensor_input(second, 0, 1'000'000));
  EXPECT_GT(next.end, one.end);
}

TEST_F(TimelineTest, SensorsSendAtTheirTriggerThoughTheThreadIsBusy) {
  timeline.set_label(thread, 0, 0);
  timeline.wait_until(thread, 1'000'000);
  const Times prompt = timeline.times(timeline.sensor_input(thread, 0, 1'000'000));
  EXPECT_EQ(prompt.queued, 1'000'000u);
  timeline.finish(thread, timeline.add_queue(kGpu1, false));
  const NodeId work = enqueue(kernel(in_order, 200'000'000));
  timeline.wait(thread, {&work, 1});
  timeline.set_label(thread, 0, 1);
  timeline.wait_until(thread, 101'000'000);  // has passed
  const Ns before = timeline.clock(thread);
  const Times late = timeline.times(timeline.sensor_input(thread, 0, 1'000'000));
  EXPECT_EQ(late.queued, 101'000'000u);
  EXPECT_EQ(late.end - late.queued, prompt.end - prompt.queued);
  EXPECT_EQ(timeline.clock(thread), before);  // it was there already
}

TEST_F(TimelineTest, AMessageTravelsToANodeOnceAndWakesWhoWaits) {
  const ThreadId soc = timeline.add_thread("soc"), second = timeline.add_thread("second");
  timeline.bind_thread(soc, "soc", 1, kGpu0);
  timeline.bind_thread(second, "second", 2, kGpu1);
  timeline.wait_until(soc, 40'000);
  const NodeId post = timeline.create_user_event(soc);
  EXPECT_THROW(timeline.message(thread, 0, post, 1000), profile::Error);  // not yet
  timeline.set_user_event(soc, post, 0);
  const Times first = timeline.times(timeline.message(thread, 0, post, 1'000'000));
  EXPECT_EQ(first.end, 40'000u + 5000 + 10'000'000);
  EXPECT_EQ(timeline.clock(thread), first.end + 200);  // the node's wake-up
  EXPECT_EQ(timeline.times(timeline.message(second, 0, post, 1'000'000)), first);
  const Times other = timeline.times(timeline.message(second, timeline.intern("b"), post, 1000));
  EXPECT_EQ(other.start, first.end);  // another name of it travels as well
  const Ns before = timeline.clock(soc);
  EXPECT_EQ(timeline.times(timeline.message(soc, 0, post, 1'000'000)).end, 40'000u);
  EXPECT_EQ(timeline.clock(soc), before);
  const Schedule again = replay(timeline.snapshot());
  EXPECT_EQ(again.makespan, timeline.horizon());
}

TEST_F(TimelineTest, MapsMoveNothingInSharedMemory) {
  ThreadId soc = timeline.add_thread("soc");
  timeline.bind_thread(soc, "soc", 1, kGpu0);
  Command c;
  c.queue = timeline.add_queue(kGpu0, false);
  c.kind = CommandKind::map;
  c.bytes = 1'000'000;
  const NodeId map = timeline.enqueue(soc, c);
  EXPECT_EQ(timeline.times(map).end - timeline.times(map).start, 400u);
  c.kind = CommandKind::read;
  const NodeId read = timeline.enqueue(soc, c);
  EXPECT_EQ(timeline.times(read).end - timeline.times(read).start, 500'400u);
}

TEST_F(TimelineTest, CallbackRunsAtTheEndOfItsEvent) {
  const NodeId k = enqueue(kernel(in_order, 1000));
  const ThreadId callback = timeline.begin_callback(k, CallbackAt::end);
  EXPECT_EQ(timeline.clock(callback), timeline.times(k).end);
  timeline.enqueue(callback, kernel(in_order, 10));
  timeline.end_callback(callback);
  const Record record = timeline.snapshot();
  EXPECT_EQ(record.threads.size(), 2u);
  EXPECT_EQ(replay(record).commands[1].times, record.commands[1].live);
}

TEST_F(TimelineTest, TheFirstBindingStartsAnEpoch) {
  Timeline fresh(small_layout());
  const ThreadId main = fresh.add_thread("main");
  const QueueId queue = fresh.add_queue(kGpu1, false);
  const NodeId warm = fresh.enqueue(main, kernel(queue, 1'000'000));
  const Times seen = fresh.times(warm);
  fresh.bind_thread(main, "branch", 0, kGpu1);
  EXPECT_EQ(fresh.clock(main), 0u);
  const NodeId k = fresh.enqueue(main, kernel(queue, 10, {&warm, 1}));
  EXPECT_EQ(fresh.times(k).start, 170u);
  EXPECT_EQ(fresh.times(warm), seen);
  const Record record = fresh.snapshot();
  ASSERT_EQ(record.commands.size(), 1u);
  EXPECT_EQ(replay(record).commands[0].times, fresh.times(k));
}

TEST(TimelineMemory, SlotsAreUsedAgainWithoutARecord) {
  Timeline timeline(small_layout(), {.record = false});
  const ThreadId thread = timeline.add_thread("main");
  const QueueId queue = timeline.add_queue(kGpu1, true);
  NodeId largest = 0;
  for (int i = 0; i < 50'000; ++i) {
    const NodeId node = timeline.enqueue(thread, kernel(queue, 10));
    largest = std::max(largest, node);
    timeline.release(node);
  }
  EXPECT_LT(largest, 10u);
  EXPECT_THROW(timeline.times(largest), profile::Error);
}

TEST(TimelineMemory, TheRecordHasALimit) {
  Timeline timeline(small_layout(), {.record = true, .record_limit = 10});
  const ThreadId thread = timeline.add_thread("main");
  const QueueId queue = timeline.add_queue(kGpu1, true);
  for (int i = 0; i < 25; ++i) timeline.release(timeline.enqueue(thread, kernel(queue, 10)));
  const Record record = timeline.snapshot();
  EXPECT_EQ(record.commands.size(), 10u);
  EXPECT_FALSE(record.complete);
  EXPECT_EQ(replay(record).commands.size(), 10u);
}

TEST(TimelineErrors, IdsAreChecked) {
  Timeline timeline(small_layout());
  const ThreadId thread = timeline.add_thread("main");
  EXPECT_THROW(timeline.add_queue(99, false), profile::Error);
  EXPECT_THROW(timeline.enqueue(thread, kernel(5, 1)), profile::Error);
  EXPECT_THROW(timeline.times(7), profile::Error);
  const QueueId queue = timeline.add_queue(kGpu1, true);
  EXPECT_THROW(timeline.enqueue(thread, kernel(queue, Ns{1} << 50)), profile::Error);
  const NodeId node = timeline.enqueue(thread, kernel(queue, 1));
  timeline.release(node);
  EXPECT_THROW(timeline.release(node), std::logic_error);
  EXPECT_THROW(timeline.wait_until(thread, ~Ns{0}), profile::Error);
  Layout bad = small_layout();
  bad.links.clear();
  EXPECT_THROW(Timeline{bad}, profile::Error);
}

TEST(TimelineEnergy, IdleBusyAndMovedBytesAddUp) {
  const auto machine = profile::load_machine("tx2", PARTITA_SOURCE_DIR "/profiles");
  Timeline timeline(make_layout(machine));
  const ThreadId thread = timeline.add_thread("main");
  const QueueId queue = timeline.add_queue(0, false);
  Command c = kernel(queue, 1'000'000);
  timeline.enqueue(thread, c);
  timeline.finish(thread, queue);
  const Record record = timeline.snapshot();
  const Schedule schedule = replay(record);
  const Energy joules = energy(schedule, record, machine);
  const auto& gpu = machine.devices[0].profile.power;
  EXPECT_NEAR(joules.items[0].busy_j, (gpu.busy_w - gpu.idle_w) * 1e-3, 1e-9);
  EXPECT_NEAR(joules.items[0].idle_j, gpu.idle_w * static_cast<double>(schedule.makespan) * 1e-9,
              1e-12);
  EXPECT_GT(joules.total(), joules.items[0].total());
}

TEST(TimelineRecord, AppearsWholeOrNotAtAll) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / "partita_record";
  fs::create_directories(folder);
  const Record record = run_programs(3, 3, {});
  save_record(record, (folder / "a.jsonl").string());
  EXPECT_EQ(load_record((folder / "a.jsonl").string()).commands.size(), record.commands.size());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  EXPECT_THROW(save_record(record, (folder / "no" / "a.jsonl").string()), profile::Error);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace partita::timeline::test
