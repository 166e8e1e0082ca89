#include "motion/skeleton/bone_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <vector>

namespace neuvv::motion {

namespace {

// What programs call a bone, the most telling name first: lower case, without side, separators and prefix.
struct BoneNames {
    const char* title;
    std::vector<std::string> names;
    bool sided;
    bool needed;
};

// In this order bones are looked for, and none is taken twice: the "foot" of a skeleton with ankles is its toes.
const std::array<BoneNames, kBoneKinds>& bone_names() {
    static const std::array<BoneNames, kBoneKinds> names = {{
        {"head", {"head", "skull"}, false, true},
        {"neck", {"neck", "shouldercenter", "spineshoulder", "midshoulder"}, false, false},
        {"pelvis", {"pelvis", "hips", "hip", "midhip", "hipcenter", "spinebase"}, false, false},
        {"nose", {"nose"}, false, false},
        {"upper arm", {"upperarm", "uparm", "uarm", "armupper", "humerus", "shldr", "arm", "shoulder"}, true, true},
        {"forearm", {"forearm", "lowerarm", "lowarm", "farm", "armlower", "ulna", "radius", "elbow"}, true, true},
        {"hand", {"wrist", "hand"}, true, true},
        {"shin", {"shin", "calf", "lowerleg", "lowleg", "leglower", "tibia", "knee", "leg"}, true, true},
        {"thigh", {"thigh", "upleg", "upperleg", "legupper", "femur", "hip", "leg"}, true, true},
        {"foot", {"ankle", "foot", "talus"}, true, true},
        {"toes", {"toes", "toebase", "toe", "ball", "foot"}, true, false},
        {"heel", {"heel", "calcn"}, true, false},
        {"big toe", {"bigtoe", "footindex"}, true, false},
        {"small toe", {"smalltoe"}, true, false},
    }};
    return names;
}

// Words that name no part of a body: of layers, types and conventions.
bool is_noise(const std::string& word) {
    constexpr const char* kNoise[] = {"j",     "bip", "c",    "m",       "x",    "b",   "def",      "org", "mixamorig",
                                      "joint", "jnt", "bone", "stretch", "bend", "skl", "skeleton", "rig"};
    return std::ranges::find(kNoise, word) != std::end(kNoise);
}

Side side_of(const std::string& word) {
    return word == "l" || word == "left" ? Side::kLeft : word == "r" || word == "right" ? Side::kRight : Side::kNone;
}

bool is_known(const std::string& name) {
    return std::ranges::any_of(bone_names(),
                               [&](const BoneNames& bone) { return std::ranges::count(bone.names, name) > 0; });
}

// The words of a name, in lower case: "J_Bip_L_UpperArm", "lForeArm", "LeftForeArm" and "RBigToe" → j bip l upper arm,
// l fore arm, left fore arm, r big toe. What stands before a colon or a bar is the name of the skeleton.
std::vector<std::string> words_of(const std::string& name) {
    const auto at = [&](size_t i) { return static_cast<unsigned char>(i < name.size() ? name[i] : '\0'); };
    std::vector<std::string> words(1);
    const size_t first = name.find_last_of(":|") + 1;
    for (size_t i = first; i < name.size(); ++i) {
        const bool begins = i > first && std::isupper(at(i)) &&
                            (std::islower(at(i - 1)) || (std::isupper(at(i - 1)) && std::islower(at(i + 1))));
        if ((begins || !std::isalpha(at(i))) && !words.back().empty()) words.emplace_back();
        if (std::isalpha(at(i))) words.back() += static_cast<char>(std::tolower(at(i)));
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

// The last number in a name, 0 where there is none: of "upper_arm.L" and "upper_arm.L.001" the first is the bone.
size_t number_of(const std::string& name) {
    constexpr const char* kDigits = "0123456789";
    const size_t last = name.find_last_of(kDigits);
    if (last == std::string::npos) return 0;
    const size_t before = name.find_last_not_of(kDigits, last);
    size_t number = 0;
    std::from_chars(name.data() + (before == std::string::npos ? 0 : before + 1), name.data() + last + 1, number);
    return number;
}

bool tells_a_part(const std::string& word) {
    return side_of(word) == Side::kNone && !is_noise(word);
}

// Whether the first word may be one that names share: a part is named behind it, as in "Bip L UpperArm".
bool has_part_behind(const std::vector<std::string>& words) {
    return words.size() > 1 && side_of(words[0]) == Side::kNone &&
           std::any_of(words.begin() + 1, words.end(), tells_a_part);
}

// Takes the words off with which most names begin: "Bip L UpperArm", "CC Base L UpperArm", "m avg L Elbow".
void drop_shared_words(std::vector<std::vector<std::string>>& all) {
    while (true) {
        std::map<std::string, size_t> firsts;
        size_t named = 0;
        for (const std::vector<std::string>& words : all) {
            named += !words.empty();
            if (has_part_behind(words)) ++firsts[words[0]];
        }
        const auto most = std::ranges::max_element(firsts, {}, [](const auto& first) { return first.second; });
        if (most == firsts.end() || 2 * most->second <= named) return;
        for (std::vector<std::string>& words : all)
            if (has_part_behind(words) && words[0] == most->first) words.erase(words.begin());
    }
}

struct PlainName {
    std::string name;
    Side side = Side::kNone;
    size_t number = 0;
};

// A side that is written together with the name: "lfemur", "leftupleg", "LUArm", "handr".
void part_from_side(PlainName& plain) {
    for (const std::string side : {"left", "right", "l", "r"})
        for (const bool before : {true, false}) {
            if (before ? !plain.name.starts_with(side) : !plain.name.ends_with(side)) continue;
            std::string rest = plain.name;
            rest.erase(before ? 0 : rest.size() - side.size(), side.size());
            if (!is_known(rest)) continue;
            plain.name = rest;
            plain.side = side_of(side);
            return;
        }
}

std::vector<PlainName> plain_names(std::span<const std::string> names) {
    std::vector<std::vector<std::string>> all;
    for (const std::string& name : names) all.push_back(words_of(name));
    drop_shared_words(all);
    std::vector<PlainName> plain(names.size());
    for (size_t i = 0; i < names.size(); ++i) {
        for (const std::string& word : all[i]) {
            const Side side = side_of(word);
            if (side != Side::kNone && plain[i].side == Side::kNone)
                plain[i].side = side;
            else if (!is_noise(word))
                plain[i].name += word;
        }
        plain[i].number = number_of(names[i]);
        if (plain[i].side == Side::kNone && !is_known(plain[i].name)) part_from_side(plain[i]);
    }
    return plain;
}

// Of bones with one name, the one with the least number: the others continue it.
std::optional<size_t> first_named(std::span<const PlainName> plain, const std::vector<bool>& taken,
                                  const std::string& name, Side side) {
    std::optional<size_t> first;
    for (size_t i = 0; i < plain.size(); ++i)
        if (!taken[i] && plain[i].name == name && plain[i].side == side)
            if (!first || plain[i].number < plain[*first].number) first = i;
    return first;
}

// Rigify's head is the seventh bone of its spine.
std::optional<size_t> head_of_spine(std::span<const PlainName> plain) {
    constexpr size_t kRigifyHead = 6;
    for (size_t i = 0; i < plain.size(); ++i)
        if (plain[i].name == "spine" && plain[i].number == kRigifyHead) return i;
    return std::nullopt;
}

}  // namespace

FoundBones find_bones(std::span<const std::string> names) {
    const std::vector<PlainName> plain = plain_names(names);
    std::vector<bool> taken(names.size(), false);
    FoundBones found;
    for (size_t kind = 0; kind < kBoneKinds; ++kind) {
        const BoneNames& wanted = bone_names()[kind];
        for (const Side side : {Side::kRight, Side::kLeft}) {
            if (!wanted.sided && side == Side::kLeft) continue;
            std::optional<size_t>& bone = found.bones[kind][side == Side::kLeft];
            for (const std::string& name : wanted.names)
                if (!bone) bone = first_named(plain, taken, name, wanted.sided ? side : Side::kNone);
            if (!bone && kind == kHeadBone) bone = head_of_spine(plain);
            if (bone) taken[*bone] = true;
        }
    }
    return found;
}

std::string FoundBones::missing() const {
    std::string text;
    for (size_t kind = 0; kind < kBoneKinds; ++kind) {
        const BoneNames& wanted = bone_names()[kind];
        for (const Side side : {Side::kRight, Side::kLeft}) {
            if (!wanted.needed || (!wanted.sided && side == Side::kLeft) || bones[kind][side == Side::kLeft]) continue;
            if (kind == kHeadBone && has(kNoseBone)) continue;  // which is all that is wanted of a head
            text += fmt::format("{}{}{}", text.empty() ? "" : ", ",
                                !wanted.sided          ? ""
                                : side == Side::kRight ? "right "
                                                       : "left ",
                                wanted.title);
        }
    }
    return text;
}

}  // namespace neuvv::motion
