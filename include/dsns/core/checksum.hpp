#pragma once
/// A checksum of bytes, and numbers in little-endian order whatever this machine's is.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

namespace dsns {

namespace detail {

/// The number whose little-endian bytes begin at `bytes`; the caller knows that there are enough.
template <class T>
T from_little_endian(const char* bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, bytes, sizeof raw);
  if constexpr (std::endian::native != std::endian::little) std::reverse(std::begin(raw), std::end(raw));
  T value;
  std::memcpy(&value, raw, sizeof value);
  return value;
}

template <class T>
void append_little_endian(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof raw);
  if constexpr (std::endian::native != std::endian::little) std::reverse(std::begin(raw), std::end(raw));
  bytes.append(raw, sizeof raw);
}

}  // namespace detail

/// XXH64: 64 bits that change with every change of the bytes, by accident at any rate; several GB a second.
/// accuracy the published values [core/checksum_test]
/// source   Collet, xxHash fast digest algorithm, version 0.1.1
inline std::uint64_t xxh64(std::string_view bytes, std::uint64_t seed = 0) {
  constexpr std::uint64_t p1 = 11400714785074694791u, p2 = 14029467366897019727u, p3 = 1609587929392839161u,
                          p4 = 9650029242287828579u, p5 = 2870177450012600261u;
  const auto lane = [](std::uint64_t sum, std::uint64_t input) { return std::rotl(sum + input * p2, 31) * p1; };
  const char *at = bytes.data(), *const end = at + bytes.size();
  const auto left = [&] { return end - at; };
  std::uint64_t hash = seed + p5;
  if (left() >= 32) {
    std::uint64_t sums[] = {seed + p1 + p2, seed + p2, seed, seed - p1};
    while (left() >= 32)
      for (std::uint64_t& sum : sums) sum = lane(sum, detail::from_little_endian<std::uint64_t>(at)), at += 8;
    hash = std::rotl(sums[0], 1) + std::rotl(sums[1], 7) + std::rotl(sums[2], 12) + std::rotl(sums[3], 18);
    for (const std::uint64_t sum : sums) hash = (hash ^ lane(0, sum)) * p1 + p4;
  }
  hash += bytes.size();
  for (; left() >= 8; at += 8)
    hash = std::rotl(hash ^ lane(0, detail::from_little_endian<std::uint64_t>(at)), 27) * p1 + p4;
  for (; left() >= 4; at += 4)
    hash = std::rotl(hash ^ detail::from_little_endian<std::uint32_t>(at) * p1, 23) * p2 + p3;
  for (; left() > 0; ++at) hash = std::rotl(hash ^ static_cast<unsigned char>(*at) * p5, 11) * p1;
  hash = (hash ^ hash >> 33) * p2;
  hash = (hash ^ hash >> 29) * p3;
  return hash ^ hash >> 32;
}

}  // namespace dsns
