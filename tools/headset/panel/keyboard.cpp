// The panel's keyboard, by which performers are renamed and addresses are typed.
#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/performer_edits.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

constexpr size_t kMaxName = 40, kMaxAddress = 200;  // bytes
constexpr size_t kShownLetters = 36;                // of a text: its end

size_t most_letters(const HeadsetState& state) {
    return state.types_address ? kMaxAddress : kMaxName;
}

// Removes the last character of UTF-8.
void erase_last(std::string& text) {
    while (!text.empty()) {
        const auto last = static_cast<unsigned char>(text.back());
        text.pop_back();
        if ((last & 0xc0) != 0x80) return;
    }
}

// The keys of a line, each as wide as in a line of ten, in the centre of the panel.
void key_line(Rows& rows, const char* keys, bool shift) {
    const float one = column_width(10), gap = ImGui::GetStyle().ItemSpacing.x;
    const auto count = static_cast<float>(std::char_traits<char>::length(keys));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 0.5f * (10 - count) * (one + gap));
    for (const char* key = keys; *key; ++key) {
        if (key != keys) ImGui::SameLine();
        const char letter = shift && *key >= 'a' && *key <= 'z' ? static_cast<char>(*key - 'a' + 'A') : *key;
        const char name[] = {'k', 'e', 'y', ' ', *key, 0}, label[] = {letter, 0};
        if (rows.button(name, label, one) && rows.state.typed.size() < most_letters(rows.state))
            rows.state.typed += letter;
    }
}

}  // namespace

// A name begins with a capital letter, until a letter is typed.
void keyboard_rows(Rows& rows) {
    HeadsetState& state = rows.state;
    const bool shift = !state.types_address && (state.typed.empty() || state.typed.back() == ' ');
    const size_t hidden = state.typed.size() > kShownLetters ? state.typed.size() - kShownLetters : 0;
    ImGui::Text("%s %s_", state.types_address ? ICON_PLUS : ICON_PERSON, state.typed.c_str() + hidden);
    for (const char* keys : {"1234567890", "qwertyuiop", "asdfghjkl", "zxcvbnm-"}) key_line(rows, keys, shift);
    if (state.types_address) key_line(rows, ":/._~?=&%", false);
    const float one = column_width(4);
    if (state.types_address) {
        if (rows.button("key https", "https", one) && state.typed.empty()) state.typed = "https://";
    } else if (rows.button("key space", "Space", one) && !state.typed.empty() && state.typed.size() < kMaxName) {
        state.typed += ' ';
    }
    ImGui::SameLine();
    if (rows.button("key back", "Back", one)) erase_last(state.typed);
    ImGui::SameLine();
    if (rows.button("key cancel", "Cancel", one)) state.dialogue = PanelDialogue::kNone;
    ImGui::SameLine();
    ImGui::BeginDisabled(state.typed.empty());
    if (rows.button("key done", state.types_address ? ICON_CHECK " Open" : ICON_CHECK " Rename", one)) {
        if (state.types_address)
            rows.result.open = state.typed;
        else
            rename_selected(state, state.typed);
        state.dialogue = PanelDialogue::kNone;
    }
    ImGui::EndDisabled();
}

}  // namespace neuvv::headset
