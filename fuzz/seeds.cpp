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
  write("obj", "square.obj", "# a comment\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 1 1e0 0\nv 0 1 0\nvt 0 0\nf 1 2/1 3//2 -1\n");
  write("repair", "tetrahedron", std::string{"\1\0\1\2\0\3\1\0\2\3\1\3\2", 13});
  return written ? 0 : 1;
}
