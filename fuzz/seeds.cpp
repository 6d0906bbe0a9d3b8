// seeds FOLDER: the files that the tests make, one folder for each fuzzer.
#include "support/gltf_fixtures.hpp"
#include "support/state_dicts.hpp"

#include <dsns/nn/surface_archive.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  bool written = true;
  const auto write = [&](const std::string& fuzzer, const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories(folder / fuzzer);
    std::ofstream file(folder / fuzzer / name, std::ios::binary);
    file << bytes;
    written = written && file.good();
  };
  using namespace dsns::test;
  write("gltf", "slide.glb", sliding_triangle().glb());
  write("gltf", "slide.gltf", sliding_triangle().gltf());
  write("gltf", "joints.glb", two_joints().glb());
  write("gltf", "joints.gltf", two_joints().gltf());
  write("gltf", "morphs.glb", two_morphs(2).glb());
  write("obj", "square.obj",
        "# a comment\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1e0 0\nv 0 1 0\nvt 0 0\nf 1 2/1 3//2 -1\n");
  write("off", "triangle.off", "OFF # comment\n3 1 0\n0 0 0\n1 0 0\n0 1 -1e-3\n3 0 1 2 255 0 0\n");
  write("off", "colours.off", "COFF\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
  const std::string ply =
      "1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty int16 z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  write("ply", "text.ply", "ply\nformat ascii " + ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  for (const std::string order : {"little", "big"})
    write("ply", order + ".ply", "ply\nformat binary_" + order + "_endian " + ply + std::string(55, '\3'));
  const auto array = [](const std::string& kind) {
    const std::string header = "{'descr': '" + kind + "', 'fortran_order': True, 'shape': (2, 2, 3), }\n";
    return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) + '\0' + header + std::string(96, '\1');
  };
  write("npy", "float.npy", array("<f4"));
  write("npy", "double.npy", array(">f8"));
  write("repair", "tetrahedron", std::string{"\1\0\1\2\0\3\1\0\2\3\1\3\2", 13});
  const dsns::SurfaceEncoding space{.harmonic_degree = 1, .time_frequencies = 0}, both{.harmonic_degree = 1};
  dsns::Archive neural, separable;
  dsns::store_surface(neural, dsns::BasicNeuralSurface<float>(both, dsns::Mlp<float>({19, 2, 1, 3})));
  dsns::store_surface(
      separable, dsns::SeparableSurface(dsns::TemporalModes(Eigen::MatrixXd::Ones(2, 1)), Eigen::MatrixXd::Ones(4, 3),
                                        space, dsns::Mlp<double>({3, 2, 0, 3})));
  write("archive", "neural.dsns", to_bytes(neural));
  write("archive", "separable.dsns", to_bytes(separable));
  const std::vector<Tensor> layers{{"0.weight", {2, 8}, std::vector<double>(16, 1)},
                                   {"0.bias", {2}, {1, 2}},
                                   {"1.weight", {3, 2}, std::vector<double>(6, 1)},
                                   {"1.bias", {3}, {1, 2, 3}}};
  write("state_dict", "float.safetensors", safetensors<float>(layers));
  write("state_dict", "double.safetensors", safetensors<double>(layers));
  write("state_dict", "float.npz", npz<float>(layers));
  return written ? 0 : 1;
}
