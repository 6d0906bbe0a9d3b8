// seeds FOLDER: the files that the tests make, one folder for each fuzzer.
#include "support/gltf_fixtures.hpp"

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
  return written ? 0 : 1;
}
