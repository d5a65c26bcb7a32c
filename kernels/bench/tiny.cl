// The least that a launch can do: what remains of its time is overhead. `partita bench overhead`
// enqueues it by the thousand. One work-item; no assumption about `count` beyond one element.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void tiny(__global uint* count) {
  count[0] += 1u;
}
