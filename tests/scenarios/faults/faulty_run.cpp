#include "tests/scenarios/faults/faulty_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fcntl.h>
#include <limits>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <map>
#include <set>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

namespace bris {

#if defined(__x86_64__) && defined(__linux__)

namespace {

/// Where a call names its file.
enum class Names { descriptor, path, path_at, to_path, to_path_at };

struct Call {
    long number;
    const char* name;
    Names names;
    bool writes = false;
};
constexpr std::array calls{Call{SYS_write, "write", Names::descriptor, true},
                           Call{SYS_pwrite64, "pwrite", Names::descriptor, true},
                           Call{SYS_writev, "writev", Names::descriptor},
                           Call{SYS_ftruncate, "ftruncate", Names::descriptor},
                           Call{SYS_fallocate, "fallocate", Names::descriptor},
                           Call{SYS_fsync, "fsync", Names::descriptor},
                           Call{SYS_fdatasync, "fdatasync", Names::descriptor},
                           Call{SYS_open, "open", Names::path},
                           Call{SYS_openat, "openat", Names::path_at},
                           Call{SYS_rename, "rename", Names::to_path},
                           Call{SYS_renameat, "renameat", Names::to_path_at},
                           Call{SYS_renameat2, "renameat2", Names::to_path_at}};

/// Makes the kernel stop this process at the calls above only.
bool watch_calls() {
    std::vector<sock_filter> filter{
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<__u32>(offsetof(seccomp_data, nr)))};
    for (const Call& call : calls) {
        filter.push_back(
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<__u32>(call.number), 0, 1));
        filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE));
    }
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    return ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0 && raise(SIGSTOP) == 0 &&
           prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

std::string text_of(pid_t process, unsigned long long address) {
    std::array<char, 4096> text{};
    // up to the end of a page, beyond which there may be nothing
    const std::size_t bytes = text.size() - address % text.size();
    iovec here{text.data(), bytes},
        there{reinterpret_cast<void*>(address), bytes}; // NOLINT: an address of the process
    if (process_vm_readv(process, &here, 1, &there, 1, 0) <= 0) return {};
    return std::string(text.data(), strnlen(text.data(), bytes));
}

std::string file_of(pid_t process, const Call& call, const user_regs_struct& r) {
    switch (call.names) {
    case Names::descriptor: {
        std::error_code error;
        return std::filesystem::read_symlink(fmt::format("/proc/{}/fd/{}", process, r.rdi), error);
    }
    case Names::path:
    case Names::path_at: {
        const bool at = call.names == Names::path_at;
        const auto flags = static_cast<int>(at ? r.rdx : r.rsi);
        return (flags & O_ACCMODE) == O_RDONLY ? "" : text_of(process, at ? r.rsi : r.rdi);
    }
    default:
        return text_of(process, call.names == Names::to_path ? r.rsi : r.r10);
    }
}

/// The process that is watched, with its threads and its own processes.
class Watch {
public:
    Watch(pid_t process, std::string folder, Fault fault, unsigned number)
        : process_(process), folder_(std::move(folder) + "/"), fault_(fault), number_(number) {}

    /// Lets the process run to its end and returns its status.
    int run(FaultyRun& found) {
        int status = 0;
        waitpid(process_, &status, 0); // it has stopped itself
        constexpr long options = PTRACE_O_TRACESECCOMP | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK |
                                 PTRACE_O_TRACEVFORK | PTRACE_O_EXITKILL;
        ptrace(PTRACE_SETOPTIONS, process_, nullptr, options);
        ptrace(PTRACE_CONT, process_, nullptr, nullptr);
        for (;;) {
            const pid_t stopped = waitpid(-1, &status, __WALL);
            if (stopped < 0 && errno == EINTR) { // the alarm
                kill(process_, SIGKILL);
                found.outcome.hung = true;
                continue;
            }
            if (stopped < 0) return -1;
            if (!WIFSTOPPED(status)) {
                if (stopped == process_) return status;
                continue;
            }
            ptrace(PTRACE_CONT, stopped, nullptr, signal_to_pass(stopped, status, found));
        }
    }

private:
    long signal_to_pass(pid_t stopped, int status, FaultyRun& found) {
        unsigned long child = 0;
        switch (status >> 8) {
        case SIGTRAP | (PTRACE_EVENT_SECCOMP << 8):
            if (!foreign_.contains(stopped)) watch(stopped, found);
            return 0;
        case SIGTRAP | (PTRACE_EVENT_FORK << 8):
        case SIGTRAP | (PTRACE_EVENT_VFORK << 8): // another program, such as gnuplot
            ptrace(PTRACE_GETEVENTMSG, stopped, nullptr, &child);
            foreign_.insert(static_cast<pid_t>(child));
            return 0;
        default:
            // new threads and processes begin with a stop, and loading a program with a trap
            return WSTOPSIG(status) == SIGSTOP || WSTOPSIG(status) == SIGTRAP ? 0
                                                                              : WSTOPSIG(status);
        }
    }

    void watch(pid_t thread, FaultyRun& found) {
        user_regs_struct r{};
        ptrace(PTRACE_GETREGS, thread, nullptr, &r);
        const auto* call = std::ranges::find(calls, static_cast<long>(r.orig_rax), &Call::number);
        if (call == calls.end() || (fault_ == Fault::short_write && (!call->writes || r.rdx < 2)))
            return;
        const std::string file = file_of(thread, *call, r);
        if (!file.starts_with(folder_)) return;
        ++found.calls;
        const bool fails = fault_ == Fault::disk_full
                               ? found.calls >= number_ && takes_space(*call, r, file)
                               : fault_ != Fault::none && found.calls == number_;
        if (!fails) return;
        if (found.call.empty()) {
            found.call = call->name;
            found.file = file.substr(folder_.size());
        }
        if (fault_ == Fault::short_write) {
            r.rdx /= 2;
        } else {
            r.orig_rax = std::numeric_limits<unsigned long long>::max(); // no call
            r.rax = static_cast<unsigned long long>(fault_ == Fault::io_error ? -EIO : -ENOSPC);
        }
        ptrace(PTRACE_SETREGS, thread, nullptr, &r);
    }

    /// Whether a call needs space on the disk that its file did not have when the disk became full.
    bool takes_space(const Call& call, const user_regs_struct& r, const std::string& file) {
        namespace fs = std::filesystem;
        if (room_.empty())
            for (const auto& entry : fs::recursive_directory_iterator(folder_))
                if (entry.is_regular_file()) room_[entry.path().string()] = entry.file_size();
        switch (call.number) {
        case SYS_write:
        case SYS_writev:
            return true;
        case SYS_pwrite64:
            return r.r10 + r.rdx > room_[file];
        case SYS_fallocate:
            return r.rdx + r.r10 > room_[file];
        case SYS_open:
        case SYS_openat:
            return !room_.contains(file);
        default:
            return false;
        }
    }

    pid_t process_;
    std::string folder_;
    std::map<std::string, std::uintmax_t> room_; // bytes of the files at that moment
    Fault fault_;
    unsigned number_;
    std::set<pid_t> foreign_;
};

extern "C" void note_alarm(int) {}

} // namespace

FaultyRun run_with_fault(const std::vector<std::string>& words, const std::filesystem::path& folder,
                         Fault fault, unsigned number, const std::function<bool()>& prepare,
                         double seconds) {
    struct sigaction interrupt {
    }, before{};
    interrupt.sa_handler = note_alarm; // without SA_RESTART, so that waiting ends
    sigaction(SIGALRM, &interrupt, &before);
    Process process(words, [&] { return (!prepare || prepare()) && watch_calls(); });
    FaultyRun found;
    alarm(static_cast<unsigned>(seconds));
    const int status = Watch(process.id(), folder, fault, number).run(found);
    alarm(0);
    sigaction(SIGALRM, &before, nullptr);
    found.outcome = process.ended(status, found.outcome.hung);
    return found;
}

std::string why_no_faults() {
    const TemporaryDirectory folder;
    const FaultyRun run = run_with_fault({"settle", "--version"}, folder.path(), Fault::none, 0);
    return run.outcome.code == 0 ? "" : "ptrace or seccomp is not permitted here";
}

#else

FaultyRun run_with_fault(const std::vector<std::string>&, const std::filesystem::path&, Fault,
                         unsigned, const std::function<bool()>&, double) {
    return {};
}
std::string why_no_faults() { return "faults are injected on Linux for x86-64 only"; }

#endif

} // namespace bris
