#include "tools/ui/theme.h"

#include <imgui.h>

#include <cmath>

#include "tools/ui/fonts.h"

namespace neuvv::ui {

namespace {

ImVec4 colour(unsigned rgb, float alpha = 1) {
    return {static_cast<float>(rgb >> 16 & 255) / 255, static_cast<float>(rgb >> 8 & 255) / 255,
            static_cast<float>(rgb & 255) / 255, alpha};
}

void set_colours(ImGuiStyle& style) {
    ImVec4* c = style.Colors;
    ImGui::StyleColorsDark(&style);
    c[ImGuiCol_Text] = colour(0xdedbd7);
    c[ImGuiCol_TextDisabled] = colour(0x85817c);
    c[ImGuiCol_WindowBg] = colour(0x26282b, 0.97f);
    c[ImGuiCol_ChildBg] = colour(0x000000, 0);
    c[ImGuiCol_PopupBg] = colour(0x2b2d31, 0.98f);
    c[ImGuiCol_MenuBarBg] = colour(0x1d1f21);
    c[ImGuiCol_Border] = colour(0x000000, 0.35f);
    c[ImGuiCol_FrameBg] = colour(0x17191b);
    c[ImGuiCol_FrameBgHovered] = colour(0x31353a);
    c[ImGuiCol_FrameBgActive] = colour(0x3a3f45);
    c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = colour(0x1d1f21);
    c[ImGuiCol_Button] = colour(0x3a3e44);
    c[ImGuiCol_ButtonHovered] = colour(0x4a5058);
    c[ImGuiCol_ButtonActive] = colour(0x3d8fd1);
    c[ImGuiCol_Header] = colour(0x3da3e8, 0.30f);
    c[ImGuiCol_HeaderHovered] = colour(0x3da3e8, 0.18f);
    c[ImGuiCol_HeaderActive] = colour(0x3da3e8, 0.45f);
    c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrab] = colour(0x3da3e8);
    c[ImGuiCol_SliderGrabActive] = colour(0x6dbdf2);
    c[ImGuiCol_Separator] = colour(0x000000, 0.4f);
    c[ImGuiCol_SeparatorHovered] = c[ImGuiCol_SeparatorActive] = colour(0x3da3e8, 0.8f);
    c[ImGuiCol_Tab] = colour(0x1d1f21);
    c[ImGuiCol_TabHovered] = colour(0x3da3e8, 0.4f);
    c[ImGuiCol_TabActive] = colour(0x33363b);
    c[ImGuiCol_TabUnfocused] = c[ImGuiCol_Tab];
    c[ImGuiCol_TabUnfocusedActive] = c[ImGuiCol_TabActive];
    c[ImGuiCol_PlotHistogram] = colour(0x3da3e8);
    c[ImGuiCol_ModalWindowDimBg] = colour(0x000000, 0.5f);
    c[ImGuiCol_NavHighlight] = colour(0x3da3e8, 0.6f);
}

void set_distances(ImGuiStyle& style) {
    style.WindowPadding = {10, 8};
    style.FramePadding = {7, 4};
    style.ItemSpacing = {7, 6};
    style.ItemInnerSpacing = {6, 4};
    style.IndentSpacing = 16;
    style.ScrollbarSize = 11;
    style.GrabMinSize = 9;
    style.WindowRounding = 0;
    style.FrameRounding = style.GrabRounding = style.PopupRounding = style.TabRounding = 4;
    style.ScrollbarRounding = 6;
    style.WindowBorderSize = 1;
    style.PopupBorderSize = 1;
}

}  // namespace

void apply_theme(float scale) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    set_colours(style);
    set_distances(style);
    style.ScaleAllSizes(scale);

    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    const float pixels = std::round(kFontPixels * scale);
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    config.OversampleH = 2;
    static constexpr ImWchar kFontRanges[] = {0x20,   0x24f,  0x370,  0x3ff,  0x400, 0x52f,
                                              0x2010, 0x205e, 0x2190, 0x21ff, 0};
    atlas.AddFontFromMemoryTTF(const_cast<unsigned char*>(roboto_font().data()), static_cast<int>(roboto_font().size()),
                               pixels, &config, kFontRanges);
    config.MergeMode = true;
    config.GlyphMinAdvanceX = std::round(pixels * 1.15f);
    config.GlyphOffset.y = std::round(pixels / 15);
    static constexpr ImWchar kIconRanges[] = {0xf000, 0xf2e0, 0};
    atlas.AddFontFromMemoryTTF(const_cast<unsigned char*>(icon_font().data()), static_cast<int>(icon_font().size()),
                               std::round(pixels * 0.93f), &config, kIconRanges);
}

VkClearColorValue background_colour() {
    return {{0.075f, 0.08f, 0.085f, 1.0f}};
}

}  // namespace neuvv::ui
