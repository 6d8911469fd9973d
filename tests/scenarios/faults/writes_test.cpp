// Every write of a run fails once: the run must say so in one line with exit code 4, what was
// complete must stay readable, and nothing that is incomplete may pass for complete.

#include "engine/archive.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/scenarios/faults/faulty_run.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <optional>
#include <sstream>

using namespace bris;

namespace {

namespace fs = std::filesystem;

std::vector<std::string> settle(const fs::path& out, const std::string& duration) {
    return {"settle", "--spheres",  "20",        "--duration", duration,
            "--out",  out.string(), "--threads", "1",          "--quiet"};
}
constexpr auto shorter = "0.001", longer = "0.002";

/// Pictures take most of the time of a short run, and a missing one never ends it.
bool without_gnuplot() { return setenv("PATH", "/nowhere", 1) == 0; }
/// The remaining complaints.
std::string complaints(const std::string& text) {
    std::istringstream lines(text);
    std::string found;
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("cannot draw ")) found += line + "\n";
    return found;
}

/// Whether a file begins as a file of HDF5 does; otherwise its very beginning was not written.
bool has_begun(const fs::path& file) { return read_whole(file).starts_with("\x89HDF"); }

std::optional<Hdf5File> opened_or_none(const fs::path& file) {
    try {
        return Hdf5File::open(file);
    } catch (const std::exception&) {
        return {};
    }
}

/// The points of all frames of a run file that count; none if it cannot be read, as before its
/// first frame is complete.
std::vector<float> frames_of(const fs::path& file) {
    if (!has_begun(file)) return {};
    const auto opened = opened_or_none(file);
    if (!opened) return {};
    const Hdf5File& run = *opened;
    if (!run.has_attribute("/VTKHDF/Steps", "NSteps")) return {};
    const auto frames = run.attribute<std::int64_t>("/VTKHDF/Steps", "NSteps").at(0);
    if (frames == 0) return {};
    const auto values = run.read<double>("/VTKHDF/Steps/Values");
    const auto counts = run.read<std::int64_t>("/VTKHDF/NumberOfPoints");
    auto points = run.read<float>("/VTKHDF/Points");
    const auto expected = static_cast<std::size_t>(frames * 3 * counts.at(0));
    REQUIRE(values.size() >= static_cast<std::size_t>(frames));
    REQUIRE(points.size() >= expected);
    points.resize(expected);
    return points;
}

/// The complete results of a short run and of a longer one, in folders of their own.
struct Reference {
    TemporaryDirectory folder;
    std::uint64_t shorter_state = state_of(shorter), longer_state = state_of(longer);
    std::vector<float> frames = frames_of(folder / longer / "settle.vtkhdf");
    std::string series = read_whole(folder / longer / "settle.csv");

    std::uint64_t state_of(const char* duration) {
        const auto out = folder / duration;
        REQUIRE(run_process(settle(out, duration), without_gnuplot).code == 0);
        return fingerprint(read_checkpoint(out / "settle.ckpt.h5").state);
    }
};

/// A run of the longer kind into the results of the shorter one, during which a call fails.
class Trial {
public:
    Trial(const Reference& reference, Fault fault, unsigned number)
        : reference_(reference), fault_(fault) {
        fs::copy(reference.folder / shorter, out_);
        run_ = run_with_fault(settle(out_, longer), out_, fault, number, without_gnuplot);
    }
    bool failed() const { return !run_.call.empty(); }
    std::size_t frames() const { return frames_of(out_ / "settle.vtkhdf").size(); }

    void check() const {
        CAPTURE(run_.call);
        CAPTURE(run_.file);
        CAPTURE(run_.outcome.err);
        CHECK_FALSE(run_.outcome.hung);
        CHECK(run_.outcome.signal == 0);
        if (fault_ == Fault::short_write || !failed()) {
            CHECK(run_.outcome.code == 0);
        } else if (run_.outcome.code == 0) {
            // libhdf5 tries to open a file before it creates it, and a file that could not be cut
            // off at its end is complete; check_files asks whether it is
            const bool of_hdf5 = run_.file.find(".vtkhdf") != std::string::npos ||
                                 run_.file.find(".h5") != std::string::npos;
            CHECK((of_hdf5 && (run_.call == "openat" || run_.call == "ftruncate")));
        } else {
            CHECK(run_.outcome.code == 4);
            CHECK(is_one_line_of(complaints(run_.outcome.err), "settle"));
            CHECK(run_.outcome.err.find(fs::path(run_.file).stem().stem().string()) !=
                  std::string::npos);
        }
        check_files();
    }

private:
    void check_files() const {
        for (const auto& entry : fs::directory_iterator(out_)) {
            const fs::path& file = entry.path();
            CAPTURE(file);
            CHECK(file.extension() != ".tmp");
            if (file.extension() == ".csv" && run_.outcome.code == 0)
                CHECK(read_whole(file) == reference_.series);
            if (file.extension() == ".json") CHECK(read_whole(file).ends_with("}\n"));
        }
        const auto state = fingerprint(read_checkpoint(out_ / "settle.ckpt.h5").state);
        CHECK((state == reference_.longer_state ||
               (state == reference_.shorter_state && run_.outcome.code != 0)));
        const auto frames = frames_of(out_ / "settle.vtkhdf");
        CHECK(frames.size() <= reference_.frames.size());
        CHECK(std::equal(frames.begin(), frames.end(), reference_.frames.begin()));
        if (run_.outcome.code == 0) CHECK(frames.size() == reference_.frames.size());
    }

    TemporaryDirectory folder_;
    fs::path out_ = folder_ / "out";
    const Reference& reference_;
    Fault fault_;
    FaultyRun run_;
};

constexpr std::array faults{Fault::short_write, Fault::no_space, Fault::io_error, Fault::disk_full};

/// The first calls open the run file, which is that of the earlier run until then.
constexpr unsigned calls_that_open = 2;

/// Lets every `stride`-th call fail, beginning with `first`.
void fail_calls(unsigned first, unsigned stride) {
    if (const std::string why = why_no_faults(); !why.empty()) {
        MESSAGE("skipped: " << why);
        return;
    }
    const Reference reference;
    for (const Fault fault : faults) {
        CAPTURE(static_cast<int>(fault));
        unsigned number = first;
        std::size_t frames = 0;
        for (;; number += stride) {
            CAPTURE(number);
            const Trial trial(reference, fault, number);
            if (!trial.failed()) break; // the run makes fewer calls
            trial.check();
            if (number <= calls_that_open) continue;
            CHECK(trial.frames() >= frames); // those of a run that failed earlier were complete
            frames = trial.frames();
        }
        CHECK(number > 1000); // the run was watched
    }
}

} // namespace

TEST_SUITE("faults/writes") {
    TEST_CASE("a run whose n-th write fails or is short says so, and loses nothing that was "
              "complete") {
        fail_calls(3, 101);
    }
}

TEST_SUITE("slow") {
    TEST_CASE("every write of a run may fail or be short") { fail_calls(1, 1); }
}
