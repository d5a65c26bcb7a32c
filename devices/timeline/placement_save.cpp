#include <algorithm>

#include "devices/timeline/placement.h"

namespace partita::timeline {

/// Of each calendar in use: its number (memories, then engines), how much follows, and that.
Placement::Taken Placement::save(Ns from) const {
  const auto since = [from](Ns time) { return time > from ? time - from : 0; };
  Taken taken;
  std::vector<Ns>& words = taken.words;
  words.reserve(32);
  for (EngineId engine = 0; engine < busy_.size(); ++engine) {
    const auto& all = busy_[engine].all();
    if (all.empty() || all.back().end <= from) continue;
    taken.all = taken.all && all.size() <= kMaxGaps / 2;
    taken.until = std::max(taken.until, since(all.back().end));
    auto first = all.end();
    while (first != all.begin() && (first - 1)->end > from) --first;
    words.insert(words.end(),
                 {memories_.size() + engine, static_cast<Ns>(2 * (all.end() - first))});
    for (; first != all.end(); ++first) {
      words.insert(words.end(), {since(first->start), since(first->end)});
    }
  }
  for (std::size_t memory = 0; memory < memories_.size(); ++memory) {
    const auto& all = memories_[memory].taken.all();
    if (all.empty() || all.back().from <= from) continue;
    taken.all = taken.all && all.size() <= kMaxGaps / 2;
    taken.until = std::max(taken.until, since(all.back().from));
    auto first = all.end() - 1;  // nothing is taken from there on
    while (first != all.begin() && first->from > from) --first;
    words.insert(words.end(), {memory, 0});
    const std::size_t count = words.size() - 1;
    for (; first + 1 != all.end(); ++first) {
      if (first->used == 0) continue;
      words.insert(words.end(), {since(first->from), since((first + 1)->from), first->used});
    }
    words[count] = words.size() - 1 - count;
  }
  return taken;
}

void Placement::restore(std::span<const Ns> words, Ns at) {
  clear();
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t calendar = words[i], end = i + 2 + words[i + 1];
    const bool engine = calendar >= memories_.size();
    for (i += 2; i < end; i += engine ? 2 : 3) {
      const Ns from = at + words[i], to = at + words[i + 1];
      if (engine) {
        busy_[calendar - memories_.size()].reserve(from, to);
      } else {
        memories_[calendar].taken.reserve(from, to, static_cast<std::uint32_t>(words[i + 2]));
      }
    }
  }
}

}  // namespace partita::timeline
