#include "engine/state_source.hpp"

namespace bris {

void StateHashes::add(const StatePiece& piece) {
    if (piece.first_row == 0) {
        first_array_ = arrays_.arrays().size();
        for (const auto& rows : piece.arrays) arrays_.put(rows.layout());
    }
    blocks_.push_back({first_array_, piece.ids, hash_of(piece)});
}

std::uint64_t fingerprint(const StateSource& state) {
    StateHashes hashes;
    state.for_pieces([&](const StatePiece& piece) { hashes.add(piece); });
    return hashes.fingerprint();
}

} // namespace bris
