#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// The processes that compute one run together (ranks of MPI). Without MPI, or if the program was
/// not started by mpirun or srun, there is one rank. Every function that communicates must be
/// called by all ranks, in the same order and by the thread that runs main (MPI_THREAD_FUNNELED).
/// The results do not depend on the order in which messages arrive.
class Ranks {
public:
    using Bytes = std::vector<std::byte>;

    static unsigned rank(); ///< of this process, from 0
    static unsigned size();
    static bool is_first() { return rank() == 0; }
    static unsigned on_this_machine(); ///< ranks that share its cores and its memory
    /// Whether this build can run on several ranks.
    static bool available();

    /// True on all ranks if it is true on one.
    static bool any(bool here);
    /// The largest number of all ranks.
    static double largest(double here);
    /// The sum over ranks, or the largest of all ranks, of each entry; as many entries on each
    /// rank. Sums of real numbers are for what may depend on the order of adding.
    static void sum(std::span<std::int64_t> entries);
    static void sum(std::span<double> entries);
    static void largest(std::span<double> entries);
    /// What each rank sends to this one, given what this one sends to each; by rank.
    static std::vector<Bytes> exchange(const std::vector<Bytes>& to);
    /// Gives the first rank what all have, by rank; the others then have nothing. Plain data.
    template <class T>
    static void gather(std::vector<T>& values);
    /// What every rank gives, by rank, on all ranks.
    static std::vector<Bytes> share(const Bytes& here);

    /// Whether this process writes the files of the run, which only the first rank does. Every
    /// writer asks on all ranks, so that the others know at `meet` that they may have to wait.
    static bool writes();
    /// Waits for the first rank if files have been written since the last meeting, however long
    /// its disk takes. (Waiting for a message has an end: a rank that does not answer within 45 s
    /// has hung or is lost.)
    static void meet();

    /// A message whose length both sides know.
    struct Message {
        unsigned rank; ///< of the other side
        std::span<std::byte> bytes;
    };
    /// Sends and receives messages, at most one of each kind for each other rank.
    static void pass(std::span<const Message> send, std::span<const Message> receive);

    /// What this rank has sent since the program began.
    struct Traffic {
        std::uint64_t messages = 0, bytes = 0; ///< to one other rank, without lengths
        std::uint64_t reductions = 0;          ///< sums and largest numbers over all ranks
    };
    static const Traffic& traffic();
};

template <class T>
void Ranks::gather(std::vector<T>& values) {
    if (size() == 1) return;
    std::vector<Bytes> to(size());
    const auto bytes = std::as_bytes(std::span(values));
    to[0].assign(bytes.begin(), bytes.end());
    values = {};
    std::vector<Bytes> from = exchange(to);
    to.clear();
    std::size_t count = 0;
    for (const Bytes& some : from) count += some.size() / sizeof(T);
    values.resize(count);
    auto next = std::as_writable_bytes(std::span(values)).begin();
    for (Bytes& some : from) {
        next = std::ranges::copy(some, next).out;
        some = {};
    }
}

/// Starts and ends MPI if the program was started as one rank of several. To be made once, in main.
class RanksOfProgram {
public:
    RanksOfProgram();
    ~RanksOfProgram();
    RanksOfProgram(const RanksOfProgram&) = delete;
    RanksOfProgram& operator=(const RanksOfProgram&) = delete;

    /// To be called by a rank that ends with an error. Returns true if all ranks end so within a
    /// few seconds, as they do if all have found the same; otherwise the others must be ended by
    /// abort.
    static bool all_fail();
    /// Ends all ranks at once with an exit code.
    [[noreturn]] static void abort(int code);
};

/// Starts this program on several ranks by mpirun, with the same arguments, and waits for its end.
/// Returns its exit code. Throws InputError if this build has no MPI, OutputError if there is no
/// mpirun, SimulationError if a rank was killed.
int start_ranks(unsigned ranks, const std::vector<std::string>& arguments);

} // namespace bris
