#include "tests/performance/time_vs_error/results.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/version.hpp"
#include "tests/performance/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/file.h>
#include <unistd.h>

namespace bris::time_vs_error {

namespace {

constexpr auto header = "scene,knob,value,seed,wall_time_s,steps,contacts,error_kind,error,"
                        "measured,reference,fingerprint,compiler,machine,load,"
                        "settings,note";
constexpr std::size_t columns = 17;

std::string flags() {
#if defined(__AVX512F__)
    return "AVX-512";
#elif defined(__AVX__)
    return "AVX";
#else
    return "baseline";
#endif
}

std::string machine() { return processor() + ", " + flags(); }

std::string load() {
    std::string word = "unknown";
    std::ifstream("/proc/loadavg") >> word;
    return word;
}

std::string quoted(std::string text) {
    std::replace(text.begin(), text.end(), '"', '\'');
    std::replace(text.begin(), text.end(), '\n', ' ');
    return '"' + text + '"';
}

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> list(1);
    bool inside = false;
    for (const char c : line) {
        if (c == '"')
            inside = !inside;
        else if (c == ',' && !inside)
            list.emplace_back();
        else
            list.back() += c;
    }
    return list;
}

Line read_line(const std::string& text, const std::string& where) {
    const auto c = cells(text);
    require(c.size() == columns,
            fmt::format("{}: expected {} columns, found {}", where, columns, c.size()));
    try {
        return {.scene = c[0],
                .knob = c[1],
                .value = c[2],
                .kind = c[7],
                .settings = c[15],
                .seed = std::stoull(c[3]),
                .wall_time = std::stod(c[4]),
                .steps = std::stoull(c[5]),
                .contacts = std::stod(c[6]),
                .measured = std::stod(c[9]),
                .reference = std::stod(c[10]),
                .error = std::stod(c[8]),
                .fingerprint = c[11],
                .compiler = c[12],
                .machine = c[13],
                .load = c[14],
                .note = c[16]};
    } catch (const std::logic_error&) {
        throw InputError(where +
                         ": expected numbers for seed, time, steps, contacts and errors, found '" +
                         text + "'");
    }
}

std::string text_of(const Line& l) {
    return fmt::format("{},{},{},{},{:.6g},{},{:.6g},{},{:.6g},{:.17g},{:.17g},{},{},{},{},{},{}\n",
                       l.scene, quoted(l.knob), quoted(l.value), l.seed, l.wall_time, l.steps,
                       l.contacts, l.kind, l.error, l.measured, l.reference, l.fingerprint,
                       quoted(l.compiler), quoted(l.machine), l.load, quoted(l.settings),
                       quoted(l.note));
}

double error_of(const Kind& kind, double measured, double reference) {
    return kind.relative ? measured / reference - 1 : measured - reference;
}

/// Locks a table until this process ends, as tests/performance/tables.py does: by a file beside it,
/// since the table itself is replaced. A file system without locks does not prevent a run.
void hold(const std::filesystem::path& csv) {
    const auto lock = csv.parent_path() / fmt::format(".{}.lock", csv.filename().string());
    const int file = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666); // never closed
    if (file < 0) return;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) {
        const std::string process = std::to_string(getpid());
        if (ftruncate(file, 0) != 0 || write(file, process.data(), process.size()) < 0) return;
    } else if (errno == EWOULDBLOCK) {
        throw InputError(fmt::format("--out: expected no other campaign at '{}', found process {}",
                                     csv.string(), read_whole(lock)));
    }
}

} // namespace

void stamp(Outcome& outcome) {
    outcome.compiler = compiler();
    outcome.machine = machine();
    outcome.load = load();
}

Results::Results(std::filesystem::path csv) : csv_(std::move(csv)) {
    hold(csv_);
    if (!std::filesystem::exists(csv_)) return;
    std::istringstream in(read_whole(csv_));
    std::string text;
    std::getline(in, text);
    require(text == header, fmt::format("{}:1: expected the columns '{}', found '{}'",
                                        csv_.string(), header, text));
    for (int number = 2; std::getline(in, text); ++number)
        lines_.push_back(read_line(text, fmt::format("{}:{}", csv_.string(), number)));
}

bool Results::has(const Scene& scene, const std::string& knob, const std::string& value,
                  std::uint64_t seed) const {
    return std::all_of(scene.kinds.begin(), scene.kinds.end(), [&](const Kind& kind) {
        return std::any_of(lines_.begin(), lines_.end(), [&](const Line& l) {
            return l.scene == scene.name && l.knob == knob && l.value == value && l.seed == seed &&
                   l.kind == kind.name;
        });
    });
}

std::optional<Outcome> Results::outcome(const Scene& scene, const Settings& settings,
                                        std::uint64_t seed) const {
    Outcome found;
    const std::string text = settings.text();
    for (const Kind& kind : scene.kinds) {
        const auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) {
            return l.scene == scene.name && l.settings == text && l.seed == seed &&
                   l.kind == kind.name;
        });
        if (line == lines_.end()) return {};
        found.wall_time = line->wall_time;
        found.steps = line->steps;
        found.contacts = line->contacts;
        found.fingerprint = line->fingerprint;
        found.note = line->note;
        found.compiler = line->compiler;
        found.machine = line->machine;
        found.load = line->load;
        found.measured.push_back({line->measured, kind.exact ? line->reference : unknown});
    }
    return found;
}

void Results::add(const Scene& scene, const Knob& knob, const std::string& value,
                  const Settings& settings, std::uint64_t seed, const Outcome& outcome,
                  const std::optional<Outcome>& reference) {
    std::erase_if(lines_, [&](const Line& l) {
        return l.scene == scene.name && l.knob == knob.label && l.value == value && l.seed == seed;
    });
    for (std::size_t k = 0; k < scene.kinds.size(); ++k) {
        const Kind& kind = scene.kinds[k];
        const Measured m = k < outcome.measured.size() ? outcome.measured[k] : Measured{};
        const bool known = reference && k < reference->measured.size();
        const double against = kind.exact ? m.reference
                               : known    ? reference->measured[k].value
                                          : unknown;
        lines_.push_back({.scene = scene.name,
                          .knob = knob.label,
                          .value = value,
                          .kind = kind.name,
                          .settings = settings.text(),
                          .seed = seed,
                          .wall_time = outcome.wall_time,
                          .steps = outcome.steps,
                          .contacts = outcome.contacts,
                          .measured = m.value,
                          .reference = against,
                          .error = error_of(kind, m.value, against),
                          .fingerprint = outcome.fingerprint,
                          .compiler = outcome.compiler,
                          .machine = outcome.machine,
                          .load = outcome.load,
                          .note = outcome.note});
    }
    std::string text = fmt::format("{}\n", header);
    for (const Line& line : lines_) text += text_of(line);
    write_whole(csv_, text);
}

} // namespace bris::time_vs_error
