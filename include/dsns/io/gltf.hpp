#pragma once
/// Animated meshes from and to glTF files. Needs tinygltf: link dsns::gltf.
#include <dsns/io/gltf_own_mesh.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/gltf_writer.hpp>
#include <dsns/io/source_name.hpp>
