#include "catch.hpp"
#include "support/state_dicts.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/state_dict_file.hpp>

namespace state_dict_file_test {

using namespace dsns;

namespace {

const std::vector<test::Tensor> tensors{{"layer.weight", {2, 3}, {1, 2, 3, 4, 5, 6.25}},
                                        {"layer.bias", {2}, {-1, 0.5}},
                                        {"step", {}, {7}},
                                        {"nothing", {0, 4}, {}}};

bool contains(const std::string& whole, const std::string& part) {
  CAPTURE(whole);
  return whole.find(part) != std::string::npos;
}

std::string safetensors_with(const std::string& header, std::size_t data) {
  return test::little_endian(header.size(), 8) + header + std::string(data, '\0');
}

std::string said(const std::string& bytes) {
  const std::string s = test::complaint<FileError>(
      [&] { detail::state_dict_from(detail::parse_safetensors(bytes, "a.safetensors"), "a.safetensors"); });
  if (!s.empty()) {
    CHECK(test::is_one_sentence(s));
    CHECK(s.rfind("a.safetensors", 0) == 0);
  }
  return s;
}

}  // namespace

TEST_CASE("state dicts: npz and safetensors of both precisions hold the same arrays", "[io]") {
  const test::TemporaryFolder folder;
  for (const auto& path :
       {folder.write("a.safetensors", test::safetensors<float>(tensors)),
        folder.write("b.safetensors", test::safetensors<double>(tensors)),
        folder.write("a.npz", test::npz<float>(tensors)), folder.write("b.npz", test::npz<double>(tensors))}) {
    CAPTURE(path);
    const Archive dict = read_state_dict(path);
    CHECK(dict.arrays().size() == 4);
    const auto& weight = dict.get<Eigen::MatrixXd>("layer.weight", 2, 3);
    CHECK(weight(0, 1) == 2);
    CHECK(weight(1, 2) == 6.25);
    CHECK(dict.get<Eigen::MatrixXd>("layer.bias", 2, 1)(1) == 0.5);
    CHECK(dict.number("step") == 7);
    CHECK(dict.get<Eigen::MatrixXd>("nothing").size() == 0);
  }
  CHECK_THROWS_AS(read_state_dict(folder.write("a.pt", "PK")), FileError);
  CHECK_THROWS_AS(read_state_dict(folder.write("c.npz", test::npz<float>({{"x", {1, 1, 1}, {1}}}))), FileError);
  CHECK_THROWS_AS(read_state_dict(folder.write("c.npz", test::npz<float>({tensors[0], tensors[0]}))), FileError);
}

TEST_CASE("state dicts: safetensors that are cut or altered in their sizes are refused with what is wrong", "[io]") {
  const std::string good = test::safetensors<float>(tensors);
  CHECK(said(good).empty());
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(said(good.substr(0, n)).empty());
  CHECK_FALSE(said(good + '\0').empty());
  for (std::size_t n = 0; n < good.size(); ++n) {  // read or refused
    std::string damaged = good;
    damaged[n] = static_cast<char>(damaged[n] ^ 0x15);
    said(damaged);
  }
  const std::string x = R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})";
  CHECK(said(safetensors_with(x, 8)).empty());
  CHECK(said(safetensors_with(" {\n \"x\\\"\" : {\"shape\":[ 2 ], \"data_offsets\":[0,8],\"dtype\":\"F32\"}} ", 8))
            .empty());
  CHECK(contains(said(safetensors_with(x, 9)), "end at 8 of 9"));
  CHECK(contains(said(safetensors_with(x, 7)), "ends at 8 of 7"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"I64","shape":[1],"data_offsets":[0,8]}})", 8)), "type I64"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[3],"data_offsets":[0,8]}})", 8)),
                 "8 bytes for 3"));
  CHECK(contains(
      said(safetensors_with(R"({"x":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}})", 8)),
      "claims 4294967296"));
  CHECK(contains(
      said(safetensors_with(R"({"x":{"dtype":"F32","shape":[99999999999999999999],"data_offsets":[0,8]}})", 8)),
      "whole number"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[-2],"data_offsets":[0,8]}})", 8)),
                 "whole number"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[8,0]}})", 8)), "lacks"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[2]}})", 8)), "lacks"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[2],"shape":[2],"data_offsets":[0,8]}})", 8)),
                 "lacks"));
  CHECK(contains(said(safetensors_with(R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8],"q":[1]}})", 8)),
                 "has 'q'"));
  CHECK(contains(said(safetensors_with(R"({"x":3})", 8)), "no '{'"));
  CHECK(contains(said(safetensors_with(x + "x", 8)), "behind its end"));
  const std::string again = R"({"dtype":"F32","shape":[2],"data_offsets":[0,8]})";
  CHECK(contains(said(safetensors_with(R"({"x":)" + again + R"(,"y":)" + again + "}", 8)), "share"));
  CHECK(contains(said(safetensors_with(R"({"x":)" + again + R"(,"x":)" + again + "}", 8)), "twice"));
  CHECK(contains(
      said(safetensors_with(R"({"x":)" + again + R"(,"y":{"dtype":"F32","shape":[2],"data_offsets":[4,12]}})", 12)),
      "overlap"));
  CHECK(contains(said(safetensors_with(R"({"x\u0041":)" + again + "}", 8)), "unusual character"));
  CHECK(contains(said(test::little_endian(~std::size_t(0), 8) + "{}"), "claims a header"));
}

}  // namespace state_dict_file_test
