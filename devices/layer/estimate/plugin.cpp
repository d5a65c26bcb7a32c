#include <llvm/Bitcode/BitcodeReader.h>
#include <llvm/IR/DiagnosticInfo.h>
#include <llvm/IR/LLVMContext.h>
#include <llvm/IR/Module.h>
#include <llvm/Support/MemoryBuffer.h>

#include "devices/layer/estimate/counter.h"
#include "devices/layer/estimate_plugin.h"

namespace {

int estimate(const void* bitcode, std::size_t bytes, const char* kernel,
             std::uint64_t unknown_trips, partita::Work* per_item, std::uint64_t* iterations) {
  llvm::LLVMContext context;
  context.setDiagnosticHandlerCallBack([](const llvm::DiagnosticInfo&, void*) {});
  const llvm::MemoryBufferRef buffer(llvm::StringRef(static_cast<const char*>(bitcode), bytes),
                                     "program.bc");
  auto module = llvm::parseBitcodeFile(buffer, context);
  if (!module) {
    llvm::consumeError(module.takeError());
    return 1;
  }
  llvm::Function* function = (*module)->getFunction(kernel);
  if (!function || function->isDeclaration()) return 1;
  partita::layer::Counter counter(unknown_trips);
  const partita::layer::Count& count = counter.count(*function);
  *per_item = count.work;
  *iterations = count.iterations;
  return 0;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int partita_estimate(
    const void* bitcode, std::size_t bytes, const char* kernel, std::uint64_t unknown_trips,
    partita::Work* per_item, std::uint64_t* iterations) {
  try {
    return estimate(bitcode, bytes, kernel, unknown_trips, per_item, iterations);
  } catch (...) {
    return 1;
  }
}
