#pragma once

#include <map>
#include <string>

namespace bris {

/// The numbers of a flat object of JSON, by their names; those that are null are left out. A number
/// may stand in quotes. Throws InputError, without a place: what was expected and what was found.
std::map<std::string, double> json_numbers(const std::string& text);

/// The first of a long text.
std::string beginning_of(const std::string& text);

} // namespace bris
