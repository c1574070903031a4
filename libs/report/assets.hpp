#pragma once
/// The files of page/ as text.

namespace noctule::report {

extern const char* const kFigureStyle;  ///< figure.css: colours, lines and words of every drawing
extern const char* const kPageStyle;    ///< page.css
extern const char* const kPageScript;   ///< page.js

}  // namespace noctule::report
