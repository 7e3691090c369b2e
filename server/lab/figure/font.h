// Font sizes of figures [px].
#pragma once

namespace handrail::figure {

inline constexpr double kTitleFont = 16.0;
inline constexpr double kSubtitleFont = 12.0;
inline constexpr double kPanelFont = 13.0;
inline constexpr double kAxisFont = 12.0;
inline constexpr double kTickFont = 11.0;
inline constexpr double kNoteFont = 10.5;
inline constexpr double kLeastFont = 7.0;
inline constexpr double kBold = 1.08;      // how much wider bold text is
inline constexpr double kLine = 16.0;      // from one line of text to the next
inline constexpr double kBaseLine = 0.35;  // from a line's middle down to its base, in font sizes

}  // namespace handrail::figure
