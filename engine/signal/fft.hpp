#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace bris {

/// Whether 2, 3 and 5 are the only prime factors of a length (at least 1).
bool is_fast_length(std::size_t length);
/// The largest length up to `length` (at least 1) without other prime factors than 2, 3 and 5.
std::size_t fast_length_within(std::size_t length);
/// The smallest such length of at least `length`.
std::size_t fast_length_for(std::size_t length);

/// Discrete Fourier transform of real series of one length N: X_k = sum_n x_n exp(-2 pi i k n / N).
class Fft {
public:
    /// Throws InputError unless 2, 3 and 5 are the only prime factors of `length`: other factors
    /// take a time that grows with their square.
    explicit Fft(std::size_t length);
    ~Fft();
    Fft(Fft&&) noexcept;
    Fft(const Fft&) = delete;

    std::size_t length() const { return length_; }
    /// X_k for k = 0 ... N/2; the others are their complex conjugates. Relative error below 1e-14.
    /// Throws InputError if the series has another length.
    std::vector<std::complex<double>> transform(std::span<const double> series);
    /// The series of which these are the X_k for k = 0 ... N/2. Throws InputError for another
    /// number of values.
    std::vector<double> series_of(std::span<const std::complex<double>> spectrum);

private:
    struct Plan;
    std::size_t length_;
    std::unique_ptr<Plan> plan_;
};

} // namespace bris
