#pragma once

namespace bris {

/// Makes SIGINT and SIGTERM ask for an orderly stop instead of ending the process. A second SIGINT
/// ends it at once with exit code 130.
void catch_interrupts();

/// Whether the user has asked to stop. Any thread may ask; costs one load.
bool interrupted();

} // namespace bris
