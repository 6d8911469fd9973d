#pragma once

namespace bris {

/// Makes SIGINT, SIGTERM, SIGHUP (the terminal is closed), SIGUSR1 (which queueing systems send
/// before the end of a job) and SIGXCPU (the limit of processor time is reached) request an orderly
/// stop instead of ending the process. A second SIGINT ends the process at once with exit code 130,
/// and so does a second SIGTERM 5 s after the first request or later: queueing systems send one
/// twice. A write beyond the limit of file sizes (SIGXFSZ) fails as one on a full disk does.
void catch_interrupts();

/// Whether the user has asked to stop. Any thread may call it; it costs one atomic load.
bool interrupted();

} // namespace bris
