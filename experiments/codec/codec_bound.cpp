// SPDX-License-Identifier: Apache-2.0
#include "experiments/codec/codec_bound.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace telekerf::experiments {
namespace {

using std::numbers::pi;

std::vector<double> without_mean(std::vector<double> x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  for (auto& value : x) value -= mean;
  return x;
}

/// Radix 2, in place; the size is a power of two.
void fourier(std::vector<std::complex<double>>& x) {
  const auto size = x.size();
  for (std::size_t i = 1, j = 0; i < size; ++i) {
    auto bit = size >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j |= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t span = 2; span <= size; span *= 2) {
    for (std::size_t k = 0; k < span / 2; ++k) {
      const auto turn = std::polar(1.0, -2 * pi * static_cast<double>(k) / static_cast<double>(span));
      for (std::size_t at = k; at < size; at += span) {
        const auto odd = turn * x[at + span / 2];
        x[at + span / 2] = x[at] - odd;
        x[at] += odd;
      }
    }
  }
}

double mean_of(const std::vector<double>& values, double (*term)(double, double), double theta) {
  double sum = 0;
  for (const double v : values) sum += term(v, theta);
  return sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<RatePoint> gaussian_limit(const std::vector<double>& variances, const std::vector<double>& rmse) {
  std::vector<RatePoint> limit;
  const double largest = *std::max_element(variances.begin(), variances.end());
  for (const double wanted : rmse) {
    double low = 0, high = largest;
    for (int i = 0; i < 200; ++i) {  // the distortion grows with theta
      const double theta = 0.5 * (low + high);
      const double distortion = mean_of(
          variances, [](double v, double t) { return std::min(v, t); }, theta);
      (distortion < wanted * wanted ? low : high) = theta;
    }
    const double bits = mean_of(
        variances, [](double v, double t) { return v > t && t > 0 ? 0.5 * std::log2(v / t) : 0.0; }, high);
    limit.push_back({wanted, bits});
  }
  return limit;
}

std::vector<double> spectrum_of(const codec::Trace& trace) {
  std::size_t size = 4096;
  while (size > trace.size()) size /= 2;
  std::vector<double> window(size);
  double power = 0;
  for (std::size_t n = 0; n < size; ++n) {
    window[n] = std::pow(std::sin(pi * (static_cast<double>(n) + 0.5) / static_cast<double>(size)), 4);
    power += window[n] * window[n];
  }
  std::vector<double> all;
  for (const auto& column : trace.values) {
    const auto x = without_mean(column);
    std::vector<double> spectrum(size);
    int segments = 0;
    for (std::size_t at = 0; at + size <= x.size(); at += size / 4, ++segments) {
      std::vector<std::complex<double>> part(size);
      for (std::size_t n = 0; n < size; ++n) part[n] = x[at + n] * window[n];
      fourier(part);
      for (std::size_t k = 0; k < size; ++k) spectrum[k] += std::norm(part[k]) / power;
    }
    for (auto& value : spectrum) all.push_back(value / segments);
  }
  return all;
}

std::vector<double> block_variances_of(const codec::Trace& trace, int block) {
  std::vector<double> all;
  for (const auto& column : trace.values) {
    const auto x = without_mean(column);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(block, block);
    const auto windows = x.size() - static_cast<std::size_t>(block) + 1;
    for (std::size_t at = 0; at < windows; ++at) {
      const Eigen::Map<const Eigen::VectorXd> part(&x[at], block);
      covariance.noalias() += part * part.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance / static_cast<double>(windows),
                                                                Eigen::EigenvaluesOnly);
    for (const double value : solver.eigenvalues()) all.push_back(std::max(value, 0.0));
  }
  return all;
}

}  // namespace telekerf::experiments
