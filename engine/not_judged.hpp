#pragma once

#include "engine/errors.hpp"

namespace bris {

/// The results are complete and written, but say less than the user required.
struct NotJudged : Error {
    using Error::Error;
};

} // namespace bris
