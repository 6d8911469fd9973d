#pragma once

#include "systems/output/frames.hpp"

#include <string>
#include <vector>

namespace bris {

/// The option --write: what goes into files next to the run file.
struct WriteOption {
    std::string write = "nothing";

    /// `choices`: what the scenario has.
    void declare_options(auto& option, const std::vector<std::string>& choices) {
        option("write", write, "",
               "What to write into files next to the run file. surfaces: the surfaces of all "
               "rocks as triangles, 8 kB for each rock and frame. contacts: a line for each "
               "contact, with its normal and shear force.",
               choices);
    }
    Extras extras() const {
        const auto has = [&](const char* what) { return write.find(what) != std::string::npos; };
        return {.surfaces = has("surfaces"), .contacts = has("contacts")};
    }
};

inline const std::vector<std::string> write_of_clumps{"nothing", "surfaces", "contacts",
                                                      "surfaces,contacts"};
/// The spheres of the run file are their own surfaces.
inline const std::vector<std::string> write_of_spheres{"nothing", "contacts"};
/// Poses that are estimated have no contacts.
inline const std::vector<std::string> write_of_estimate{"nothing", "surfaces"};

} // namespace bris
