#include "engine/named_value.hpp"

#include <fmt/format.h>

namespace bris {

std::string NamedValue::text() const {
    return std::visit([](const auto& x) { return fmt::format("{}", x); }, value);
}

} // namespace bris
