#include "engine/state_source.hpp"

namespace bris {

void StateHashes::add(const StatePiece& piece) {
    if (piece.first_row == 0) arrays_.put(piece.layout());
    hashes_.add(piece);
}

std::uint64_t fingerprint(const StateSource& state) {
    StateHashes hashes;
    state.for_pieces([&](const StatePiece& piece) { hashes.add(piece); });
    return hashes.fingerprint();
}

} // namespace bris
