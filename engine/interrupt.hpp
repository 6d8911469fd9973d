#pragma once

namespace bris {

/// Makes SIGINT and SIGTERM request an orderly stop instead of ending the process. A second SIGINT
/// ends the process at once with exit code 130.
void catch_interrupts();

/// Whether the user has asked to stop. Any thread may call it; it costs one atomic load.
bool interrupted();

} // namespace bris
