#pragma once
/// Named arrays as one string of bytes: what checkpoints are written as. The bytes are the same on every machine, carry
/// their version and a checksum, and are read without trust.
///
///   Archive archive;
///   archive.set("harmonics", coefficients);          // a matrix of float, double or int64, a number, or a text
///   const std::string bytes = to_bytes(archive);
///   parse_archive(bytes, "walk.dsns").get<Eigen::MatrixXd>("harmonics");
///
/// Layout, all numbers little-endian:
///   8 bytes  magic: 0x89 "DSNS" CR LF 0x1a
///   u32 u32  major and minor version: readers refuse a newer major one and read past what a newer minor one adds
///   u64      size of all, in bytes
///   u64      number of arrays; then for each, in the order of their names,
///     u32 u32    length of the name; type: 1 float, 2 double, 3 int64, 4 text (rows bytes, one column)
///     u64 u64    rows and columns
///     ...        the name, then the entries column after column
///   u64      xxh64 of everything before
#include <dsns/core/checksum.hpp>
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <concepts>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <variant>

namespace dsns {

class Archive {
 public:
  using Integers = Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic>;
  using Value = std::variant<Eigen::MatrixXf, Eigen::MatrixXd, Integers, std::string>;

  /// name   what it is called in messages: the file it came from
  explicit Archive(std::string name = "the checkpoint") : name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  const std::map<std::string, Value, std::less<>>& arrays() const { return arrays_; }
  bool contains(std::string_view array) const { return arrays_.find(array) != arrays_.end(); }

  /// Adds or replaces an array.
  void set(std::string array, Value value) { arrays_.insert_or_assign(std::move(array), std::move(value)); }
  /// A number is a matrix of one entry, int64 or double.
  template <class N>
  requires(std::integral<N> || std::floating_point<N>) void set(std::string array, N number) {
    using Matrix = std::conditional_t<std::integral<N>, Integers, Eigen::MatrixXd>;
    set(std::move(array), Value(Matrix(Matrix::Constant(1, 1, static_cast<typename Matrix::Scalar>(number)))));
  }

  /// The array of a name, V one of Value's types. Here and below:
  /// throws   FileError where there is none, or one of another kind
  template <class V>
  const V& get(std::string_view array) const {
    const auto found = arrays_.find(array);
    require<FileError>(found != arrays_.end(), name_, " holds no '", array, "': it is a file of another kind");
    const V* value = std::get_if<V>(&found->second);
    require<FileError>(value != nullptr, name_, ": '", array, "' holds ", kind(found->second.index()), ", wanted were ",
                       kind(Value(V()).index()));
    return *value;
  }
  template <class V>
  const V& get(std::string_view array, Index rows, Index cols) const {
    const V& value = get<V>(array);
    require<FileError>(value.rows() == rows && value.cols() == cols, name_, ": '", array, "' is ", value.rows(), " x ",
                       value.cols(), ", wanted was ", rows, " x ", cols);
    return value;
  }
  double number(std::string_view array) const { return get<Eigen::MatrixXd>(array, 1, 1)(0); }
  /// throws   FileError also where the number is outside of [low, high]
  std::int64_t integer(std::string_view array, std::int64_t low = std::numeric_limits<std::int64_t>::min(),
                       std::int64_t high = std::numeric_limits<std::int64_t>::max()) const {
    const std::int64_t value = get<Integers>(array, 1, 1)(0);
    require<FileError>(value >= low && value <= high, name_, ": '", array, "' is ", value, ", outside of ", low, " to ",
                       high);
    return value;
  }
  const std::string& text(std::string_view array) const { return get<std::string>(array); }

 private:
  static const char* kind(std::size_t type) {
    constexpr const char* kinds[] = {"numbers in single precision", "numbers in double precision", "integers",
                                     "a text"};
    return kinds[type];
  }

  std::string name_;
  std::map<std::string, Value, std::less<>> arrays_;
};

namespace detail {

inline constexpr std::string_view archive_magic =
    "\x89"
    "DSNS\r\n\x1a";
inline constexpr std::uint32_t archive_major = 1, archive_minor = 0;
inline constexpr std::size_t archive_header = 32, archive_checksum = 8;

template <class V>
void append_entries(std::string& bytes, const V& value) {
  if constexpr (std::is_same_v<V, std::string>) {
    bytes += value;
  } else if constexpr (std::endian::native == std::endian::little) {
    bytes.append(reinterpret_cast<const char*>(value.data()),
                 static_cast<std::size_t>(value.size()) * sizeof(typename V::Scalar));
  } else {
    for (Index k = 0; k < value.size(); ++k) append_little_endian(bytes, value.data()[k]);
  }
}

inline void append_array(std::string& bytes, const std::string& name, const Archive::Value& value) {
  append_little_endian(bytes, static_cast<std::uint32_t>(name.size()));
  append_little_endian(bytes, static_cast<std::uint32_t>(value.index() + 1));
  std::visit(
      [&](const auto& v) {
        auto rows = static_cast<std::uint64_t>(v.size()), cols = std::uint64_t(1);
        if constexpr (requires { v.rows(); })
          rows = static_cast<std::uint64_t>(v.rows()), cols = static_cast<std::uint64_t>(v.cols());
        append_little_endian(bytes, rows);
        append_little_endian(bytes, cols);
        bytes += name;
        append_entries(bytes, v);
      },
      value);
}

/// Takes parts off the front of the bytes, never more than there are.
class ArchiveReader {
 public:
  ArchiveReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(&name) {}

  std::size_t left() const { return bytes_.size(); }
  std::string_view take(std::uint64_t size) {
    require<FileError>(size <= bytes_.size(), *name_, " claims ", size, " bytes where ", bytes_.size(),
                       " are left: it was not written by dsns");
    const std::string_view taken = bytes_.substr(0, std::size_t(size));
    bytes_.remove_prefix(std::size_t(size));
    return taken;
  }
  template <class T>
  T number() {
    return from_little_endian<T>(take(sizeof(T)).data());
  }
  template <class V>
  V matrix(std::uint64_t rows, std::uint64_t cols) {
    using Scalar = typename V::Scalar;
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    require<FileError>(rows <= most && cols <= most, *name_, " claims an array of ", rows, " x ", cols,
                       " entries: it was not written by dsns");
    const std::string_view raw = take(rows * cols <= bytes_.size() ? rows * cols * sizeof(Scalar) : rows * cols);
    V value(static_cast<Index>(rows), static_cast<Index>(cols));
    if constexpr (std::endian::native == std::endian::little)
      std::copy(raw.begin(), raw.end(), reinterpret_cast<char*>(value.data()));
    else
      for (Index k = 0; k < value.size(); ++k)
        value.data()[k] = from_little_endian<Scalar>(raw.data() + std::size_t(k) * sizeof(Scalar));
    return value;
  }

 private:
  std::string_view bytes_;
  const std::string* name_;
};

inline Archive::Value parse_array(ArchiveReader& reader, std::uint32_t type, std::uint64_t rows, std::uint64_t cols,
                                  const std::string& name) {
  switch (type) {
    case 1:
      return reader.matrix<Eigen::MatrixXf>(rows, cols);
    case 2:
      return reader.matrix<Eigen::MatrixXd>(rows, cols);
    case 3:
      return reader.matrix<Archive::Integers>(rows, cols);
    case 4:
      require<FileError>(cols == 1, name, " has a text of ", cols, " columns: it was not written by dsns");
      return std::string(reader.take(rows));
    default:
      fail<FileError>(name, " has an array of the unknown type ", type, ": it was not written by dsns");
  }
}

}  // namespace detail

inline std::string to_bytes(const Archive& archive) {
  std::string body;
  for (const auto& [name, value] : archive.arrays()) detail::append_array(body, name, value);
  std::string bytes(detail::archive_magic);
  bytes.reserve(detail::archive_header + body.size() + detail::archive_checksum);
  detail::append_little_endian(bytes, detail::archive_major);
  detail::append_little_endian(bytes, detail::archive_minor);
  detail::append_little_endian(
      bytes, static_cast<std::uint64_t>(detail::archive_header + body.size() + detail::archive_checksum));
  detail::append_little_endian(bytes, static_cast<std::uint64_t>(archive.arrays().size()));
  bytes += body;
  detail::append_little_endian(bytes, xxh64(bytes));
  return bytes;
}

/// accuracy parse_archive(to_bytes(a)) holds what a does, to the bit; every truncation and every changed byte is refused
///          [core/archive_test]
/// throws   FileError, one sentence that begins with `name`
inline Archive parse_archive(std::string_view bytes, const std::string& name) {
  const auto check = [&](bool ok, const auto&... what) { require<FileError>(ok, name, what...); };
  check(bytes.substr(0, 8) == detail::archive_magic, " is no .dsns file: write one with dsns fit -o FILE.dsns");
  check(bytes.size() >= detail::archive_header + detail::archive_checksum, " is cut short after ", bytes.size(),
        " bytes: copy or write it again");
  detail::ArchiveReader reader(bytes.substr(8, bytes.size() - 8 - detail::archive_checksum), name);
  const auto major = reader.number<std::uint32_t>();
  reader.number<std::uint32_t>();  // a newer minor version only adds arrays
  check(major <= detail::archive_major, " has version ", major, " of the format, this program reads ",
        detail::archive_major, ": take a newer dsns");
  const auto size = reader.number<std::uint64_t>();
  check(size == bytes.size(), " has ", bytes.size(), " bytes of ", size, ": copy or write it again");
  const auto checksum =
      detail::from_little_endian<std::uint64_t>(bytes.data() + bytes.size() - detail::archive_checksum);
  check(xxh64(bytes.substr(0, bytes.size() - detail::archive_checksum)) == checksum,
        " is damaged, its checksum is wrong: copy or write it again");
  Archive archive(name);
  for (auto count = reader.number<std::uint64_t>(); count > 0; --count) {
    const auto length = reader.number<std::uint32_t>(), type = reader.number<std::uint32_t>();
    const auto rows = reader.number<std::uint64_t>(), cols = reader.number<std::uint64_t>();
    std::string array(reader.take(length));
    check(!archive.contains(array), " holds '", array, "' twice: it was not written by dsns");
    archive.set(std::move(array), detail::parse_array(reader, type, rows, cols, name));
  }
  check(reader.left() == 0, " has ", reader.left(), " bytes behind its arrays: it was not written by dsns");
  return archive;
}

}  // namespace dsns
