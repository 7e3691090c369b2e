// Scenes with a painted map, as files.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/scene/scene_io.h"
#include "tests/support/png_sample.h"
#include "tests/support/temp_folder.h"

namespace handrail {

// A scene in a folder of its own, with a map of 120 x 100 pixels: paper, and ink from row 60 down.
class PaintedScene : public testing::Test {
 protected:
  PaintedScene() {
    png_.width = 120;
    png_.height = 100;
    png_.pixel = [](int, int y) {
      return y < 60 ? test::Pixel{240, 224, 192, 255} : test::Pixel{32, 48, 64, 255};
    };
  }
  Result<Scene> load(const std::string& more = "", const std::string& image = kImage,
                     const std::vector<Override>& overrides = {}) {
    folder_.write("maps/a.png", test::png_of(png_));
    const std::string text = "name: 'a'\nwalls {\n" + image + kPalette + more + "}\n";
    return load_scene_file(folder_.write("a.scene", text), nullptr, overrides);
  }
  // What is wrong, without the folder.
  std::string error_of(const std::string& more = "", const std::string& image = kImage) {
    std::string text = load(more, image).message();
    const std::string folder = folder_.path() + "/";
    for (std::size_t at; (at = text.find(folder)) != std::string::npos;) {
      text.erase(at, folder.size());
    }
    return text;
  }
  static inline const std::string kImage =
      "image { file: 'maps/a.png' size_mm: [24, 20] edges: SRGB }\n";
  static inline const std::string kPalette =
      "region { name: 'paper' kind: FREE colour: '#f0e0c0' }\n"
      "region { name: 'ink' kind: WALL colour: '#203040' }\n";
  TempFolder folder_;
  test::PngSample png_;
};

}  // namespace handrail
