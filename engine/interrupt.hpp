#pragma once

#include <functional>
#include <list>
#include <string>

namespace bris {

/// While it exists, SIGINT, SIGTERM, SIGHUP (the terminal is closed), SIGUSR1 (which queueing
/// systems send before the end of a job) and SIGXCPU (the limit of processor time is reached) are
/// requests to stop. After a request
/// - `interrupted` is true: whoever looks may end the program in order, with its own message;
/// - whatever has nothing to save need not look: a third of a second later the program ends where
///   it is, with one line and exit code 130, after the actions of all Cleanups. Results are files
///   that are either there as a whole or not at all (UnfinishedFile);
/// - a run whose state is worth saving (SavesWhenInterrupted) has 1.5 s of processor time to come
///   to the place where it saves, at most 10 s by the clock; nothing ends it while it saves
///   (Saving).
/// A second SIGINT ends the program at once, and so does a second SIGTERM 5 s after the first
/// request or later: queueing systems send one twice. A write beyond the limit of file sizes
/// (SIGXFSZ) fails as one on a full disk does. To be made once, in main.
class CatchInterrupts {
public:
    /// `program`: the name with which its line begins.
    explicit CatchInterrupts(const std::string& program);
    ~CatchInterrupts(); ///< the signals act as before
    CatchInterrupts(const CatchInterrupts&) = delete;
    /// The line is left to another process.
    void be_silent();
};

/// Whether the user has asked to stop. Any thread may call it; it costs one atomic load.
bool interrupted();

/// Around a call that another program makes, such as Python, which goes on after Ctrl-C: while it
/// exists, SIGINT makes `interrupted` true, so that the call can end early. At its end the handler
/// of that program is back, and gets the signal. Not together with CatchInterrupts.
class InterruptibleCall {
public:
    InterruptibleCall();
    ~InterruptibleCall();
    InterruptibleCall(const InterruptibleCall&) = delete;
};

/// What the last of the runs that were to be saved has said of its continuation, where one has
/// ended after a request; empty: nothing.
std::string how_to_continue();

/// Around a run that saves its state, and throws Interrupted, soon after `interrupted` has become
/// true.
class SavesWhenInterrupted {
public:
    /// `continuation`: such as "continue with --resume FILE". Where one run is within another, that
    /// of the outer one counts.
    explicit SavesWhenInterrupted(std::string continuation);
    ~SavesWhenInterrupted();
    SavesWhenInterrupted(const SavesWhenInterrupted&) = delete;

private:
    std::string continuation_;
};

/// Around what takes its time, whether the user has asked to stop or not: saving a state, or
/// waiting for other processes that do so.
class Saving {
public:
    Saving();
    ~Saving();
    Saving(const Saving&) = delete;
};

/// What is done if a request to stop ends the program while the object exists: a file is removed, a
/// process ended. Elsewhere the owner does so in its destructor.
class Cleanup {
public:
    /// The action is called by another thread; it must neither throw nor wait for one.
    explicit Cleanup(std::function<void()> action);
    ~Cleanup();
    Cleanup(const Cleanup&) = delete;

private:
    std::list<std::function<void()>>::iterator place_;
};

} // namespace bris
