// Reads hostile files: `fuzz [--reader NAME] [--inputs N] [--first N] [--seed N]`. Each input is
// made from a valid one by a deterministic mutator. A reader must accept it or refuse it with an
// InputError or an OutputError, within a second of processor time, and with no more memory than ten
// times the input and 64 MiB. An input that makes it fail is kept as a file; so is one that ends
// the process, for example under the address sanitizer.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/options.hpp"
#include "engine/scenario.hpp"
#include "tests/fuzz/mutator.hpp"
#include "tests/fuzz/readers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <malloc.h>
#include <new>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

namespace {

// memory of this process; libraries have threads that begin and end
std::atomic<std::size_t> memory_in_use = 0, most_memory = 0;

void* counted(std::size_t size) {
    void* const found = std::malloc(std::max<std::size_t>(size, 1));
    if (found == nullptr) throw std::bad_alloc();
    const std::size_t used = memory_in_use += malloc_usable_size(found);
    for (std::size_t most = most_memory; used > most;)
        if (most_memory.compare_exchange_weak(most, used)) break;
    return found;
}
void release(void* at) {
    if (at != nullptr) memory_in_use -= malloc_usable_size(at);
    std::free(at);
}

} // namespace

#ifdef __SANITIZE_ADDRESS__
// libraries may allocate with the sanitizer's own operators and free with those below
extern "C" __attribute__((visibility("default"))) const char* __asan_default_options() {
    return "alloc_dealloc_mismatch=0";
}
#endif

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* at) noexcept { release(at); }
void operator delete[](void* at) noexcept { release(at); }
void operator delete(void* at, std::size_t) noexcept { release(at); }
void operator delete[](void* at, std::size_t) noexcept { release(at); }

namespace {

using namespace bris;
namespace fs = std::filesystem;

constexpr double longest = 1.5; ///< s, of processor time; a child process may take one

struct Fuzz {
    std::string reader;
    std::uint64_t inputs = 2000, first = 0, seed = 1;

    void declare_options(Options& option) {
        option("reader", reader, "", "Only this reader. Empty: all.");
        option("inputs", inputs, "", "Number of inputs for each reader.", within(1, 1e12));
        option("first", first, "", "Number of the first input, to go on with a series.",
               within(0, 1e12));
        option("seed", seed, "", "Seed of the inputs.");
    }
};

struct Count {
    std::uint64_t accepted = 0, refused = 0;
    double slowest = 0; ///< s
    double most = 0;    ///< MiB that were allocated at once
    double beyond = 0;  ///< MiB of these beyond ten times the input
};

/// Of this process and of those that it has started and that have ended, s.
double processor_time() {
    double seconds = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage used{};
        getrusage(who, &used);
        for (const timeval& part : {used.ru_utime, used.ru_stime})
            seconds += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
    }
    return seconds;
}

/// Why a reader fails on a file; empty: it does not.
std::string failure_of(const FuzzedReader& reader, const fs::path& file, Count& count) {
    const std::size_t before = memory_in_use;
    most_memory = before;
    const double began = processor_time();
    try {
        reader.read(file);
        ++count.accepted;
    } catch (const InputError&) {
        ++count.refused;
    } catch (const OutputError&) {
        ++count.refused;
    } catch (const std::exception& error) {
        return fmt::format("internal error: {}", error.what());
    }
    const double seconds = processor_time() - began,
                 most = static_cast<double>(most_memory.load() - before) / 0x1p20,
                 beyond = most - 10 * static_cast<double>(fs::file_size(file)) / 0x1p20;
    count.slowest = std::max(count.slowest, seconds);
    count.most = std::max(count.most, most);
    count.beyond = std::max(count.beyond, beyond);
    if (seconds > longest) return fmt::format("takes {:.1f} s", seconds);
    if (beyond > 64) return fmt::format("takes {:.0f} MiB and ten times the input", beyond);
    return {};
}

void fuzz(const FuzzedReader& reader, const Fuzz& f, const fs::path& folder) {
    const Mutator mutator(reader.valid(assets_folder(), folder), f.seed, reader.in_place);
    const fs::path file =
        fs::absolute(fmt::format("fuzz_{}_{}{}", reader.name, getpid(), reader.extension));
    Count count;
    for (std::uint64_t number = f.first; number < f.first + f.inputs; ++number) {
        const itimerval time{{0, 0}, {20, 0}}; // a reader that hangs is ended
        setitimer(ITIMER_VIRTUAL, &time, nullptr);
        std::FILE* const out = std::fopen(file.c_str(), "wb"); // without waiting for the disk
        const std::string input = mutator.input(number);
        if (out == nullptr || std::fwrite(input.data(), 1, input.size(), out) != input.size() ||
            std::fclose(out) != 0)
            throw OutputError(fmt::format("cannot write '{}'", file.string()));
        if (const std::string why = failure_of(reader, file, count); !why.empty())
            throw SimulationError(
                fmt::format("{}: input {} of seed {}: expected a result or a refusal, found: {} "
                            "(kept as {})",
                            reader.name, number, f.seed, why, file.string()));
    }
    fs::remove(file);
    fmt::print(
        "{:12} {} inputs: {} accepted, {} refused, slowest {:.3f} s, most memory {:.3f} MiB, "
        "{:.3f} MiB beyond ten times the input\n",
        reader.name, f.inputs, count.accepted, count.refused, count.slowest, count.most,
        count.beyond);
    std::fflush(stdout);
}

void run(const Fuzz& f) {
    const fs::path folder = fs::temp_directory_path() / fmt::format("bris_fuzz_{}", getpid());
    fs::create_directories(folder);
    std::size_t found = 0;
    for (const FuzzedReader& reader : fuzzed_readers())
        if (f.reader.empty() || f.reader == reader.name) {
            fuzz(reader, f, folder);
            ++found;
        }
    fs::remove_all(folder);
    require(found > 0, fmt::format("--reader: expected the name of a reader, found {}", f.reader));
}

} // namespace

int main(int argc, char** argv) {
    return detail::exit_code_of("fuzz", [&] {
        Fuzz settings;
        Options options;
        settings.declare_options(options);
        if (detail::parse_or_answer(options, {argv + std::min(argc, 1), argv + argc}, "fuzz",
                                    "Reads files that were damaged on purpose."))
            run(settings);
    });
}
