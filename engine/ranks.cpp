#include "engine/ranks.hpp"

#include "engine/child_program.hpp"
#include "engine/errors.hpp"
#include "engine/exit_codes.hpp"
#include "engine/interrupt.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <unistd.h>
#include <utility>

#ifdef BRIS_MPI
#define OMPI_SKIP_MPICXX // only the interface in C
#include <mpi.h>
#endif

namespace bris {

namespace {
Ranks::Traffic sent_so_far; // by the thread that runs main
}

const Ranks::Traffic& Ranks::traffic() { return sent_so_far; }

#ifdef BRIS_MPI

namespace {

bool runs() {
    int started = 0, ended = 0;
    MPI_Initialized(&started);
    MPI_Finalized(&ended);
    return started != 0 && ended == 0;
}

unsigned sharing_this_machine = 1;
bool file_since_meeting = false;

// What ranks say of their end, apart from the messages for which the others may still wait.
MPI_Comm ending = MPI_COMM_NULL;

/// Waits for messages. A rank that does not answer for three quarters of a minute has hung or is
/// lost: then all end, with one line.
void wait_for(std::vector<MPI_Request>& requests) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds patience{45}, patience_when_stopped{10};
    const int count = static_cast<int>(requests.size());
    const auto began = Clock::now();
    for (std::uint64_t tries = 1;; ++tries) {
        int done = 0;
        MPI_Testall(count, requests.data(), &done, MPI_STATUSES_IGNORE);
        if (done != 0) return;
        if (tries % 64 == 0) std::this_thread::yield(); // to a rank that shares this core
        if (tries % 65536 != 0) continue;               // some ten milliseconds
        const auto waited = Clock::now() - began;
        if (waited < (interrupted() ? patience_when_stopped : patience)) continue;
        say(fmt::format(
            "rank {}: another rank has not answered for {} s: all ranks end; continue from the "
            "last checkpoint with --resume",
            Ranks::rank(), std::chrono::duration_cast<std::chrono::seconds>(waited).count()));
        RanksOfProgram::abort(static_cast<int>(ExitCode::failed));
    }
}

/// Whether all ranks come to this point within a time.
bool all_come(MPI_Comm ranks, std::chrono::steady_clock::duration within) {
    using Clock = std::chrono::steady_clock;
    MPI_Request request;
    MPI_Ibarrier(ranks, &request);
    const auto began = Clock::now();
    for (int done = 0; Clock::now() - began < within;
         std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done != 0) return true;
    }
    return false;
}

void reduce(void* entries, std::size_t count, MPI_Datatype type, MPI_Op operation) {
    ++sent_so_far.reductions;
    if (!runs() || count == 0) return;
    std::vector<MPI_Request> request(1);
    MPI_Iallreduce(MPI_IN_PLACE, entries, static_cast<int>(count), type, operation, MPI_COMM_WORLD,
                   request.data());
    wait_for(request);
}

// a message longer than an int can count is sent as several
constexpr std::size_t longest = std::size_t{1} << 30;

void start(const Ranks::Message& message, bool sends, std::vector<MPI_Request>& requests) {
    for (std::size_t first = 0; first < message.bytes.size(); first += longest) {
        const auto part =
            message.bytes.subspan(first, std::min(longest, message.bytes.size() - first));
        const int count = static_cast<int>(part.size()), other = static_cast<int>(message.rank);
        MPI_Request& request = requests.emplace_back();
        sent_so_far.messages += sends ? 1 : 0;
        sent_so_far.bytes += sends ? part.size() : 0;
        if (sends)
            MPI_Isend(part.data(), count, MPI_BYTE, other, 0, MPI_COMM_WORLD, &request);
        else
            MPI_Irecv(part.data(), count, MPI_BYTE, other, 0, MPI_COMM_WORLD, &request);
    }
}

} // namespace

unsigned Ranks::rank() {
    int rank = 0;
    if (runs()) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return static_cast<unsigned>(rank);
}

unsigned Ranks::size() {
    int size = 1;
    if (runs()) MPI_Comm_size(MPI_COMM_WORLD, &size);
    return static_cast<unsigned>(size);
}

unsigned Ranks::on_this_machine() { return sharing_this_machine; }

bool Ranks::available() { return true; }

void Ranks::sum(std::span<std::int64_t> entries) {
    reduce(entries.data(), entries.size(), MPI_INT64_T, MPI_SUM);
}

void Ranks::sum(std::span<double> entries) {
    reduce(entries.data(), entries.size(), MPI_DOUBLE, MPI_SUM);
}

void Ranks::largest(std::span<double> entries) {
    reduce(entries.data(), entries.size(), MPI_DOUBLE, MPI_MAX);
}

void Ranks::pass(std::span<const Message> send, std::span<const Message> receive) {
    std::vector<MPI_Request> requests;
    for (const Message& message : receive) start(message, false, requests);
    for (const Message& message : send) start(message, true, requests);
    wait_for(requests);
}

bool Ranks::writes() {
    file_since_meeting = true;
    return is_first();
}

void Ranks::meet() {
    if (!std::exchange(file_since_meeting, false) || !runs()) return;
    if (!is_first()) {
        all_come(MPI_COMM_WORLD, std::chrono::steady_clock::duration::max());
        return;
    }
    std::vector<MPI_Request> request(1); // nothing keeps the others
    MPI_Ibarrier(MPI_COMM_WORLD, request.data());
    wait_for(request);
}

namespace {

/// `to(rank)`: what this one sends to a rank.
template <class To>
std::vector<Ranks::Bytes> exchange_with(To&& to) {
    const unsigned here = Ranks::rank(), ranks = Ranks::size();
    std::vector<std::uint64_t> sent(ranks), received(ranks);
    for (unsigned r = 0; r < ranks; ++r) sent[r] = to(r).size();
    received = sent;
    if (runs()) {
        std::vector<MPI_Request> request(1);
        MPI_Ialltoall(sent.data(), 1, MPI_UINT64_T, received.data(), 1, MPI_UINT64_T,
                      MPI_COMM_WORLD, request.data());
        wait_for(request);
    }
    std::vector<Ranks::Bytes> from(ranks);
    from[here] = to(here);
    std::vector<Ranks::Message> send, receive;
    for (unsigned r = 0; r < ranks; ++r) {
        if (r == here) continue;
        from[r].resize(received[r]);
        // MPI only reads what is sent
        if (sent[r] > 0) send.push_back({r, {const_cast<std::byte*>(to(r).data()), to(r).size()}});
        if (received[r] > 0) receive.push_back({r, from[r]});
    }
    Ranks::pass(send, receive);
    return from;
}

} // namespace

std::vector<Ranks::Bytes> Ranks::exchange(const std::vector<Bytes>& to) {
    return exchange_with([&](unsigned r) -> const Bytes& { return to[r]; });
}

std::vector<Ranks::Bytes> Ranks::share(const Bytes& here) {
    return exchange_with([&](unsigned) -> const Bytes& { return here; });
}

RanksOfProgram::RanksOfProgram() {
    for (const char* sign : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
        if (std::getenv(sign) != nullptr && !runs()) {
            int provided = 0;
            MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
            MPI_Comm_dup(MPI_COMM_WORLD, &ending);
            MPI_Comm here = MPI_COMM_NULL;
            int size = 1;
            MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
            MPI_Comm_size(here, &size);
            MPI_Comm_free(&here);
            sharing_this_machine = static_cast<unsigned>(size);
            return;
        }
}

RanksOfProgram::~RanksOfProgram() {
    if (runs()) MPI_Finalize();
}

bool RanksOfProgram::all_fail() { return !runs() || all_come(ending, std::chrono::seconds(5)); }

void RanksOfProgram::abort(int code) {
    if (runs()) MPI_Abort(MPI_COMM_WORLD, code);
    std::exit(code);
}

#else

unsigned Ranks::rank() { return 0; }
unsigned Ranks::size() { return 1; }
unsigned Ranks::on_this_machine() { return 1; }
bool Ranks::available() { return false; }
void Ranks::sum(std::span<std::int64_t>) {}
void Ranks::sum(std::span<double>) {}
void Ranks::largest(std::span<double>) {}
void Ranks::pass(std::span<const Message>, std::span<const Message>) {}
bool Ranks::writes() { return true; }
void Ranks::meet() {}
std::vector<Ranks::Bytes> Ranks::exchange(const std::vector<Bytes>& to) { return to; }
std::vector<Ranks::Bytes> Ranks::share(const Bytes& here) { return {here}; }
RanksOfProgram::RanksOfProgram() = default;
RanksOfProgram::~RanksOfProgram() = default;
bool RanksOfProgram::all_fail() { return true; }
void RanksOfProgram::abort(int code) { std::exit(code); }

#endif

namespace {

/// As variables of the environment, because releases of Open MPI refuse each other's options.
constexpr std::pair<const char*, const char*> settings_of_mpirun[]{
    // the program itself says why it ends
    {"OMPI_MCA_orte_execute_quiet", "1"},
    {"PRTE_MCA_prte_execute_quiet", "1"},
    // s, twice, for which it waits after a rank's exit code other than 0; by then all ranks have
    // said why they end
    {"OMPI_MCA_odls_base_sigkill_timeout", "0"},
    {"PRTE_MCA_odls_base_sigkill_timeout", "0"},
    {"OMPI_MCA_btl_vader_single_copy_mechanism", "none"}}; // which containers forbid

} // namespace

int start_ranks(unsigned ranks, const std::vector<std::string>& arguments) {
    require(
        Ranks::available(),
        "--ranks: expected a build with MPI, found one without (install libopenmpi-dev and build "
        "again)");
    for (const auto& [name, value] : settings_of_mpirun) setenv(name, value, 1);
    std::vector<std::string> command{"mpirun",          "-n",        std::to_string(ranks),
                                     "--oversubscribe", "--bind-to", "none"};
    if (geteuid() == 0) command.emplace_back("--allow-run-as-root");
    command.push_back(this_program().string());
    command.insert(command.end(), arguments.begin(), arguments.end());
    // in a group of its own, because mpirun kills the ranks at Ctrl-C; it passes on SIGUSR1, at
    // which they save a checkpoint
    const Saving saving;
    ChildProgram child(command, {.own_group = true});
    bool asked = false;
    while (child.runs()) {
        if (interrupted() && !std::exchange(asked, true)) child.send(SIGUSR1);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const int code = child.exit_code();
    for (const auto& [known, meaning] : exit_codes)
        if (code == static_cast<int>(known)) return code;
    if (asked) throw Interrupted("interrupted before the ranks had begun");
    throw SimulationError(fmt::format("a rank ended without a result ({} {}); continue from the "
                                      "last checkpoint with --resume",
                                      code > 128 ? "signal" : "exit code",
                                      code > 128 ? code - 128 : code));
}

double Ranks::largest(double here) {
    largest({&here, 1});
    return here;
}

bool Ranks::any(bool here) { return largest(here ? 1.0 : 0.0) > 0; }

} // namespace bris
