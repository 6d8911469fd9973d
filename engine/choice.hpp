#pragma once

#include "engine/errors.hpp"

#include <algorithm>
#include <concepts>
#include <string>
#include <type_traits>
#include <vector>

namespace bris {

/// An enumeration whose values have texts: `texts_of(E)` lists them in the order of the values.
template <class E>
concept WithTexts = std::is_enum_v<E> && requires(E value) {
    { texts_of(value) } -> std::same_as<const std::vector<std::string>&>;
};

template <WithTexts E>
const std::string& text_of(E value) {
    return texts_of(value)[static_cast<std::size_t>(value)];
}

/// The value that a text stands for. Throws InputError if there is none.
template <WithTexts E>
E named(const std::string& text) {
    const auto& texts = texts_of(E{});
    const auto found = std::ranges::find(texts, text);
    require(found != texts.end(), "expected a known name, found \"" + text + "\"");
    return static_cast<E>(found - texts.begin());
}

} // namespace bris
