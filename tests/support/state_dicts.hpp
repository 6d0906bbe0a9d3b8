#pragma once
/// Arrays as NumPy and safetensors files, put together byte by byte, without the library under test.
#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace dsns::test {

/// A tensor in C order.
struct Tensor {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

template <class T>
std::string raw_bytes(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) {
    const T x = static_cast<T>(value);
    char piece[sizeof x];
    std::memcpy(piece, &x, sizeof x);
    bytes.append(piece, sizeof x);
  }
  return bytes;
}

inline std::string joined(const std::vector<std::size_t>& numbers, bool comma_at_end) {
  std::string out;
  for (const std::size_t n : numbers) out += (out.empty() ? "" : ", ") + std::to_string(n);
  return out + (comma_at_end && numbers.size() == 1 ? "," : "");
}

inline std::string little_endian(std::size_t x, int bytes) {
  std::string out;
  for (int k = 0; k < bytes; ++k, x /= 256) out += static_cast<char>(x % 256);
  return out;
}

/// As safetensors.numpy.save writes it, T float or double.
template <class T>
std::string safetensors(const std::vector<Tensor>& tensors) {
  std::string header = R"({"__metadata__":{"format":"pt"})", data;
  for (const Tensor& t : tensors) {
    const std::string bytes = raw_bytes<T>(t.values);
    header += ",\"" + t.name + R"(":{"dtype":")" + (sizeof(T) == 4 ? "F32" : "F64") + R"(","shape":[)" +
              joined(t.shape, false) + R"(],"data_offsets":[)" + std::to_string(data.size()) + "," +
              std::to_string(data.size() + bytes.size()) + "]}";
    data += bytes;
  }
  header += "}";
  header.resize((header.size() + 7) / 8 * 8, ' ');
  return little_endian(header.size(), 8) + header + data;
}

/// As numpy.savez writes it; sums are not checked by anybody.
template <class T>
std::string npz(const std::vector<Tensor>& tensors) {
  std::string body, directory;
  for (const Tensor& t : tensors) {
    const std::string header = std::string("{'descr': '<f") + (sizeof(T) == 4 ? "4" : "8") +
                               "', 'fortran_order': False, 'shape': (" + joined(t.shape, true) + "), }\n";
    const std::string file =
        std::string("\x93NUMPY\x01\0", 8) + little_endian(header.size(), 2) + header + raw_bytes<T>(t.values);
    const std::string name = t.name + ".npy";
    const std::string common = little_endian(20, 2) + little_endian(0, 4) + little_endian(0, 8) +
                               little_endian(file.size(), 4) + little_endian(file.size(), 4) +
                               little_endian(name.size(), 2);
    directory +=
        "PK\x01\x02" + little_endian(20, 2) + common + little_endian(0, 12) + little_endian(body.size(), 4) + name;
    body += "PK\x03\x04" + common + little_endian(0, 2) + name + file;
  }
  return body + directory + "PK\x05\x06" + little_endian(0, 4) + little_endian(tensors.size(), 2) +
         little_endian(tensors.size(), 2) + little_endian(directory.size(), 4) + little_endian(body.size(), 4) +
         little_endian(0, 2);
}

}  // namespace dsns::test
