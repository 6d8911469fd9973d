#pragma once

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <string>

namespace bris {

/// Returns what `read` returns. An error of its input or of a file is thrown again with the option
/// that gives the file in front of its message.
auto naming(const std::string& option, auto&& read) {
    try {
        return read();
    } catch (const InputError& e) {
        throw InputError(fmt::format("{}: {}", option, e.what()));
    } catch (const OutputError& e) {
        throw OutputError(fmt::format("{}: {}", option, e.what()));
    }
}

} // namespace bris
