// Counts what one work-item does in LLVM code.
#ifndef PARTITA_DEVICES_LAYER_ESTIMATE_COUNTER_H
#define PARTITA_DEVICES_LAYER_ESTIMATE_COUNTER_H

#include <cstdint>
#include <llvm/IR/Function.h>
#include <llvm/IR/Instructions.h>
#include <map>
#include <set>

#include "devices/work.h"

namespace partita::layer {

/// Operations by class and bytes by direction, and the trips of the innermost loops together.
struct Count {
  Work work;  ///< its kind: gather if an address depends on loaded data, else stream
  std::uint64_t iterations = 1;
};

/// Every block counts as executed, as often as its loops turn: constant trip counts are taken from
/// the code, others are `unknown_trips`. Both sides of a branch count. Integer operations that
/// only make addresses or steer loops are left out, as in every Work. Helper functions that were
/// not inlined are counted once and added at each call.
class Counter {
 public:
  explicit Counter(std::uint64_t unknown_trips) : unknown_trips_(unknown_trips) {}
  const Count& count(llvm::Function& function);

 private:
  void instruction(llvm::Instruction& inst, std::uint64_t times, Count& count);
  void call(llvm::CallInst& inst, std::uint64_t times, Count& count);
  void built_in(llvm::StringRef name, llvm::CallInst& inst, std::uint64_t times, Count& count);
  void memory(llvm::Value* pointer, std::uint64_t bytes, bool writes, Count& count);
  bool makes_address(llvm::Value* value);

  std::uint64_t unknown_trips_;
  std::map<llvm::Function*, Count> counted_;
  std::set<llvm::Value*> visiting_;
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_ESTIMATE_COUNTER_H
