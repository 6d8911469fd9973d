#include "engine/signal/fft.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unsupported/Eigen/FFT>

namespace bris {

struct Fft::Plan {
    Eigen::FFT<double> fft;
};

bool is_fast_length(std::size_t length) {
    if (length == 0) return false;
    for (const std::size_t factor : {2u, 3u, 5u})
        while (length % factor == 0) length /= factor;
    return length == 1;
}

std::size_t fast_length_within(std::size_t length) {
    require(length > 0, "Fourier transform: expected a length of at least 1, found 0");
    while (!is_fast_length(length)) --length;
    return length;
}

std::size_t fast_length_for(std::size_t length) {
    length = std::max<std::size_t>(1, length);
    while (!is_fast_length(length)) ++length;
    return length;
}

Fft::Fft(std::size_t length) : length_(length), plan_(std::make_unique<Plan>()) {
    require(is_fast_length(length),
            fmt::format("Fourier transform: expected a length with no other prime factors than 2, "
                        "3 and 5, found {}",
                        length));
    plan_->fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
}

Fft::~Fft() = default;
Fft::Fft(Fft&&) noexcept = default;

std::vector<std::complex<double>> Fft::transform(std::span<const double> series) {
    require(series.size() == length_,
            fmt::format("Fourier transform: expected {} values, found {}", length_, series.size()));
    std::vector<std::complex<double>> spectrum(length_ / 2 + 1);
    if (length_ == 1)
        spectrum[0] = series[0];
    else
        plan_->fft.fwd(spectrum.data(), series.data(), static_cast<Eigen::Index>(length_));
    return spectrum;
}

std::vector<double> Fft::series_of(std::span<const std::complex<double>> spectrum) {
    require(spectrum.size() == length_ / 2 + 1,
            fmt::format("Fourier transform: expected {} values of a spectrum, found {}",
                        length_ / 2 + 1, spectrum.size()));
    std::vector<double> series(length_);
    if (length_ == 1)
        series[0] = spectrum[0].real();
    else
        plan_->fft.inv(series.data(), spectrum.data(), static_cast<Eigen::Index>(length_));
    return series;
}

} // namespace bris
