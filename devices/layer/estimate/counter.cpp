#include "devices/layer/estimate/counter.h"

#include <algorithm>
#include <llvm/ADT/Triple.h>
#include <llvm/Analysis/AssumptionCache.h>
#include <llvm/Analysis/LoopInfo.h>
#include <llvm/Analysis/ScalarEvolution.h>
#include <llvm/Analysis/TargetLibraryInfo.h>
#include <llvm/Analysis/ValueTracking.h>
#include <llvm/IR/Constants.h>
#include <llvm/IR/Dominators.h>
#include <llvm/IR/IntrinsicInst.h>
#include <llvm/IR/Module.h>

namespace partita::layer {
namespace {

using llvm::Instruction;
using llvm::Type;

constexpr std::uint64_t kMost = std::uint64_t{1} << 40;

std::uint64_t times(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > kMost / b ? kMost : a * b;
}

std::uint64_t lanes(const Type* type) {
  const auto* vector = llvm::dyn_cast<llvm::FixedVectorType>(type);
  return vector ? vector->getNumElements() : 1;
}

/// The floating-point class of a type: its own for double, that of float for float and half.
OpClass float_class(Type* type, OpClass single, OpClass twice) {
  return type->getScalarType()->isDoubleTy() ? twice : single;
}
OpClass add_class(Type* type) {
  return type->isFPOrFPVectorTy() ? float_class(type, OpClass::float_add, OpClass::double_add)
                                  : OpClass::int_add;
}

/// Trips of all loops around a block, multiplied.
class Trips {
 public:
  Trips(llvm::Function& function, std::uint64_t unknown)
      : library_impl_(llvm::Triple(function.getParent()->getTargetTriple())),
        library_(library_impl_),
        assumptions_(function),
        tree_(function),
        loops_(tree_),
        evolution_(function, library_, assumptions_, tree_, loops_),
        unknown_(unknown) {}

  std::uint64_t of(const llvm::BasicBlock& block) {
    std::uint64_t product = 1;
    for (const llvm::Loop* l = loops_.getLoopFor(&block); l; l = l->getParentLoop()) {
      product = times(product, of(*l));
    }
    return product;
  }
  std::uint64_t innermost() {
    std::uint64_t sum = 0;
    for (const llvm::Loop* l : loops_.getLoopsInPreorder()) {
      if (l->isInnermost()) sum += of(*l->getHeader());
    }
    return std::max<std::uint64_t>(1, std::min(sum, kMost));
  }

 private:
  std::uint64_t of(const llvm::Loop& loop) {
    const unsigned constant = evolution_.getSmallConstantTripCount(&loop);
    return constant ? constant : unknown_;
  }

  llvm::TargetLibraryInfoImpl library_impl_;
  llvm::TargetLibraryInfo library_;
  llvm::AssumptionCache assumptions_;
  llvm::DominatorTree tree_;
  llvm::LoopInfo loops_;
  llvm::ScalarEvolution evolution_;
  std::uint64_t unknown_;
};

enum class Space { none, global, local };

/// Where a pointer leads: the kernel's metadata says it of its arguments; a module's own variable
/// is __local unless it is constant. A helper's argument counts as global.
Space space_of(llvm::Value* pointer) {
  llvm::Value* object = llvm::getUnderlyingObject(pointer);
  if (llvm::isa<llvm::AllocaInst>(object)) return Space::none;
  if (const auto* global = llvm::dyn_cast<llvm::GlobalVariable>(object)) {
    return global->isConstant() ? Space::none : Space::local;
  }
  const auto* argument = llvm::dyn_cast<llvm::Argument>(object);
  if (!argument) return Space::global;
  const llvm::MDNode* spaces = argument->getParent()->getMetadata("kernel_arg_addr_space");
  if (!spaces || argument->getArgNo() >= spaces->getNumOperands()) return Space::global;
  const auto* space =
      llvm::mdconst::dyn_extract<llvm::ConstantInt>(spaces->getOperand(argument->getArgNo()));
  constexpr std::uint64_t kLocal = 3;
  return space && space->getZExtValue() == kLocal ? Space::local : Space::global;
}

/// Whether a loaded value goes into the address, within a few steps.
bool depends_on_load(const llvm::Value* value, int steps) {
  const auto* inst = llvm::dyn_cast<Instruction>(value);
  if (!inst || steps == 0 || llvm::isa<llvm::PHINode>(inst)) return false;
  if (llvm::isa<llvm::LoadInst>(inst)) return true;
  if (llvm::isa<llvm::CallInst>(inst)) return false;
  return std::any_of(inst->op_begin(), inst->op_end(), [&](const llvm::Use& operand) {
    return depends_on_load(operand.get(), steps - 1);
  });
}

bool one_of(llvm::StringRef name, std::initializer_list<llvm::StringRef> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "_Z8_cl_sqrtf" -> "sqrt"; empty if the name is not mangled, which only built-ins are.
llvm::StringRef built_in_name(llvm::StringRef mangled) {
  std::size_t length = 0;
  if (!mangled.consume_front("_Z") || mangled.consumeInteger(10, length)) return {};
  llvm::StringRef name = mangled.substr(0, length);
  for (const char* prefix : {"_cl_", "native_", "half_"}) name.consume_front(prefix);
  return name;
}

}  // namespace

const Count& Counter::count(llvm::Function& function) {
  const auto [it, fresh] = counted_.try_emplace(&function);
  Count& count = it->second;
  if (!fresh) return count;  // recursion, which OpenCL forbids, counts as nothing
  Trips trips(function, unknown_trips_);
  Count sum;
  sum.iterations = trips.innermost();
  for (llvm::BasicBlock& block : function) {
    const std::uint64_t n = trips.of(block);
    for (Instruction& inst : block) instruction(inst, n, sum);
  }
  count = sum;
  return count;
}

void Counter::instruction(Instruction& inst, std::uint64_t n, Count& count) {
  Type* type = inst.getType();
  const llvm::DataLayout& layout = inst.getModule()->getDataLayout();
  const auto add = [&](OpClass c, std::uint64_t each) { count.work[c] += times(n, each); };
  switch (inst.getOpcode()) {
    case Instruction::FAdd:
    case Instruction::FSub:
    case Instruction::FNeg:
    case Instruction::FPToSI:
    case Instruction::FPToUI:
    case Instruction::SIToFP:
    case Instruction::UIToFP:
    case Instruction::FPExt:
    case Instruction::FPTrunc:
      return add(add_class(type->isFPOrFPVectorTy() ? type : inst.getOperand(0)->getType()),
                 lanes(type));
    case Instruction::FMul:
      return add(float_class(type, OpClass::float_mul, OpClass::double_mul), lanes(type));
    case Instruction::FDiv:
    case Instruction::FRem:
      return add(float_class(type, OpClass::float_special, OpClass::double_special), lanes(type));
    case Instruction::FCmp:
      return add(add_class(inst.getOperand(0)->getType()), lanes(type));
    case Instruction::Mul:
      return makes_address(&inst) ? void() : add(OpClass::int_mul, lanes(type));
    case Instruction::SDiv:
    case Instruction::UDiv:
    case Instruction::SRem:
    case Instruction::URem:
      return add(OpClass::int_special, lanes(type));
    case Instruction::Add:
    case Instruction::Sub:
    case Instruction::And:
    case Instruction::Or:
    case Instruction::Xor:
    case Instruction::Shl:
    case Instruction::LShr:
    case Instruction::AShr:
    case Instruction::ICmp:
    case Instruction::Select:
    case Instruction::SExt:
    case Instruction::ZExt:
    case Instruction::Trunc:
      return makes_address(&inst) ? void() : add(add_class(type), lanes(type));
    case Instruction::AtomicRMW:
    case Instruction::AtomicCmpXchg:
      return add(OpClass::atomic, 1);
    case Instruction::Load:
      return memory(inst.getOperand(0), times(n, layout.getTypeStoreSize(type)), false, count);
    case Instruction::Store:
      return memory(inst.getOperand(1),
                    times(n, layout.getTypeStoreSize(inst.getOperand(0)->getType())), true, count);
    case Instruction::Call:
      return call(llvm::cast<llvm::CallInst>(inst), n, count);
    default:
      return;  // branches, addresses, phis, moves between lanes
  }
}

void Counter::memory(llvm::Value* pointer, std::uint64_t bytes, bool writes, Count& count) {
  switch (space_of(pointer)) {
    case Space::none:
      break;
    case Space::local:
      count.work.local_bytes += bytes;
      break;
    case Space::global:
      (writes ? count.work.written_issued : count.work.read_issued) += bytes;
      if (depends_on_load(pointer, 8)) count.work.kind = WorkKind::gather;
      break;
  }
}

/// Whether nothing but addresses and loop control comes of an integer. A value that feeds itself
/// (an induction variable) is followed once.
bool Counter::makes_address(llvm::Value* value) {
  if (!value->getType()->isIntOrIntVectorTy()) return false;
  if (!visiting_.insert(value).second) return true;
  const bool only = std::all_of(value->user_begin(), value->user_end(), [&](llvm::User* user) {
    if (llvm::isa<llvm::GetElementPtrInst>(user) || llvm::isa<llvm::BranchInst>(user)) return true;
    const auto* inst = llvm::dyn_cast<Instruction>(user);
    const bool passes_on =
        inst && (inst->isBinaryOp() || inst->isCast() || llvm::isa<llvm::PHINode>(inst) ||
                 llvm::isa<llvm::ICmpInst>(inst) || llvm::isa<llvm::SelectInst>(inst));
    return passes_on && makes_address(user);
  });
  visiting_.erase(value);
  return only;
}

void Counter::call(llvm::CallInst& inst, std::uint64_t n, Count& count) {
  llvm::Function* callee = inst.getCalledFunction();
  if (!callee) return;
  const llvm::StringRef name = built_in_name(callee->getName());
  if (!name.empty()) return built_in(name, inst, n, count);
  llvm::StringRef intrinsic = callee->getName();
  if (intrinsic.consume_front("llvm.")) {
    return built_in(intrinsic.take_until([](char c) { return c == '.'; }), inst, n, count);
  }
  if (callee->isDeclaration()) return;
  const Count inner = this->count(*callee);
  for (std::size_t i = 0; i < kOpClasses; ++i) count.work.ops[i] += times(n, inner.work.ops[i]);
  count.work.read_issued += times(n, inner.work.read_issued);
  count.work.written_issued += times(n, inner.work.written_issued);
  count.work.local_bytes += times(n, inner.work.local_bytes);
  count.iterations += times(n, inner.iterations);
  if (inner.work.kind == WorkKind::gather) count.work.kind = WorkKind::gather;
}

void Counter::built_in(llvm::StringRef name, llvm::CallInst& inst, std::uint64_t n, Count& count) {
  Type* type = inst.getType();
  const std::uint64_t width = times(n, lanes(type));
  const bool floating = type->isFPOrFPVectorTy();
  Work& work = count.work;
  if (name.startswith("get_") || name.startswith("lifetime") || name.startswith("dbg") ||
      one_of(name, {"barrier", "work_group_barrier", "mem_fence", "read_mem_fence",
                    "write_mem_fence", "assume", "prefetch", "experimental"})) {
    return;
  }
  if (one_of(name, {"fma", "fmuladd", "mad"}) && floating) {
    work[float_class(type, OpClass::float_fma, OpClass::double_fma)] += width;
  } else if (name == "dot") {
    work[float_class(type, OpClass::float_fma, OpClass::double_fma)] +=
        times(n, lanes(inst.getArgOperand(0)->getType()));
  } else if (name.startswith("atomic_") || name.startswith("atom_")) {
    work[OpClass::atomic] += n;
  } else if (name.startswith("vload")) {
    const auto bytes = inst.getModule()->getDataLayout().getTypeStoreSize(type);
    memory(inst.getArgOperand(1), times(n, bytes), false, count);
  } else if (name.startswith("vstore")) {
    const auto bytes =
        inst.getModule()->getDataLayout().getTypeStoreSize(inst.getArgOperand(0)->getType());
    memory(inst.getArgOperand(2), times(n, bytes), true, count);
  } else if (name.startswith("read_image") || name.startswith("write_image")) {
    constexpr std::uint64_t kPixel = 4;  // most images are 8 bit RGBA
    (name.startswith("read") ? work.read_issued : work.written_issued) += times(n, kPixel);
  } else if (one_of(name, {"mul24", "mad24", "mul_hi", "mad_hi", "mad_sat"})) {
    work[OpClass::int_mul] += width;
  } else if (one_of(name, {"popcount", "clz", "ctz", "ctpop", "ctlz", "cttz"})) {
    work[OpClass::int_special] += width;
  } else if (floating &&
             !one_of(name, {"fabs", "fmin", "fmax", "min", "max", "minnum", "maxnum", "clamp",
                            "floor", "ceil", "rint", "round", "trunc", "step", "sign", "select",
                            "copysign", "mix"}) &&
             !name.startswith("convert_") && !name.startswith("as_")) {
    work[float_class(type, OpClass::float_special, OpClass::double_special)] += width;
  } else if (!type->isVoidTy()) {
    work[add_class(type)] += width;
  }
}

}  // namespace partita::layer
