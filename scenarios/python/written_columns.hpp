#pragma once

#include "engine/world.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace bris {

/// The columns that Python may write through arrays, and what has been written. Each is compared
/// with a copy that was made when the array was handed out, so that what was not written costs no
/// check and changes nothing.
///
/// Writable are columns of the table `bodies`: position, orientation and velocity of free bodies,
/// position and drive_velocity of prescribed ones, position of fixed ones, angular_velocity of all.
/// Everything else follows from these, or from how the scene was built: masses and sizes, springs
/// of contacts, energies, and what a servo moves.
class WrittenColumns {
public:
    /// Remembers a column that is handed out for writing. Throws InputError, which lists the
    /// writable columns, if it is none of them.
    void hand_out(const std::string& table, Column& column);
    /// Checks the rows that differ from the copies, and renews what follows from them: the lists of
    /// pairs, and angular momenta. Throws InputError that names body, column and value, and changes
    /// nothing. `still_shown`: arrays may write on.
    void take_up(World& world, bool still_shown);
    void forget() { handed_out_.clear(); }

private:
    struct HandedOut {
        Column* column;
        std::vector<std::byte> before;
    };
    std::vector<HandedOut> handed_out_;
};

} // namespace bris
