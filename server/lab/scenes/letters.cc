#include "server/lab/scenes/letters.h"

#include <algorithm>
#include <cstddef>

namespace handrail {
namespace {

// From ' ' to '~', a bar after each. A letter is strokes with a space between them; a stroke is
// places, each a digit across and one down. Capitals reach from 0 to 6, tails to 8.
constexpr std::string_view kAlphabet =
    "|0004 0606|0002 2022|1016 3036 0242 0444|413010010213334445361605 2026|0640 0101 4545|"
    "4602011020310405162644|0001|20111526|00111506|0244 4204 2125|0444 2226|1607|0434|0606|"
    "0640|"
    "100105163645413010 2323|112026 1636|01103041420646|01103041423313 334445361605|"
    "36300444|4000033344453606|413010010516364544331304|004016|"
    "13020110304142331304051636454433|051636454130100102133342|"
    "0303 0606|1313 1607|300336|0343 0545|003306|01102031322324 2626|"
    "34332213142434454130100105163646|"
    "062046 1434|06003041423303 3344453606|4130100105163645|06003041453606|40000646 0333|"
    "400006 0333|41301001051636454323|0006 4046 0343|0020 1016 0626|4045361605|"
    "0006 4004 1346|000646|0600234046|06004640|100105163645413010|06003041423303|"
    "100105163645413010 2446|06003041423303 2346|413010010213334445361605|0040 2026|"
    "000516364540|002640|0016233640|0046 4006|002340 2326|00400646|"
    "10000616|0046|00101606|022042|0747|0011|"
    "1222333616051434|0006 0312223335261605|3322120305162635|3036 3322120305162635|"
    "04343322120305162635|30201116 0222|3322120305162635 3237281807|0006 0312223336|"
    "0206 0000|121708 1010|0006 3205 1436|0006|0206 03122326 23324346|0206 0312223336|"
    "120305162635332212|0208 0312223335261605|3238 3322120305162635|0206 03122233|"
    "33221203142435261605|10152636 0222|0205162635 3236|022642|0216233642|0236 3206|"
    "0226 4218|02320636|"
    "20111203141526|0007|00111223141506|04133443|";
constexpr std::string_view kBox = "0040460600";
constexpr double kHeight = 6.0;  // of capitals, in a letter's own units
constexpr int kGap = 2;          // between two letters
constexpr int kSpace = 2;        // how wide nothing is

std::string_view strokes_of(unsigned char c) {
  if (c < ' ' || c > '~') return kBox;
  std::string_view rest = kAlphabet;
  for (int i = ' '; i < c; ++i) rest.remove_prefix(rest.find('|') + 1);
  return rest.substr(0, rest.find('|'));
}

// Calls `use` with the strokes of each character and where it stands, in a letter's units. Returns
// the width of all.
template <typename Use>
int each_letter(std::string_view text, Use&& use) {
  int at = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xC0) continue;  // goes on with a character
    const std::string_view strokes = strokes_of(byte);
    use(strokes, at);
    int wide = strokes.empty() ? kSpace : 0;
    for (std::size_t i = 0; i < strokes.size(); i += strokes[i] == ' ' ? 1 : 2) {
      if (strokes[i] != ' ') wide = std::max(wide, strokes[i] - '0');
    }
    at += wide + kGap;
  }
  return std::max(at - kGap, 0);
}

}  // namespace

double letters_width(std::string_view text, double height) {
  return each_letter(text, [](std::string_view, int) {}) * height / kHeight;
}

void draw_letters(Canvas& canvas, Vec2 at, std::string_view text, double height,
                  const Colour& colour) {
  const double unit = height / kHeight;
  each_letter(text, [&](std::string_view strokes, int left) {
    const auto place = [&](std::size_t i) {
      return Vec2(at + unit * Vec2(left + strokes[i] - '0', strokes[i + 1] - '0' - kHeight));
    };
    for (std::size_t i = 0; i + 3 < strokes.size(); i += 2) {
      if (strokes[i + 2] == ' ') {
        i += 1;
        continue;
      }
      canvas.line(place(i), place(i + 2), 0.9 * unit, colour);
    }
  });
}

}  // namespace handrail
