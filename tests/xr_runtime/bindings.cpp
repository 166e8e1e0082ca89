#include "bindings.h"

#include "call.h"
#include "profiles.h"

namespace neuvv::xr_runtime {

namespace {

constexpr const char* kSimple = "/interaction_profiles/khr/simple_controller";

// Core OpenXR has more profiles than this runtime; an application may suggest bindings for them.
const Profile* offered_profile(const Instance& instance, const std::string& path) {
    const Profile* profile = find_profile(path);
    if (!profile) {
        warn("profile", fmt::format("the interaction profile {} is unknown to this runtime", path));
        decline(XR_ERROR_PATH_UNSUPPORTED);
    }
    require(!profile->extension || instance.has(profile->extension), XR_ERROR_PATH_UNSUPPORTED, "extension",
            fmt::format("bindings for {} without the extension of it enabled", path));
    return profile;
}

Binding checked_binding(const Profile& profile, const XrActionSuggestedBinding& suggested) {
    const auto action = shared<Action>(suggested.action);
    require(!action->set->is_attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action-order",
            fmt::format("bindings are suggested for '{}' after its action set was attached", action->name));
    const std::string& path = text_of(suggested.binding);
    require(has_input(profile, path), XR_ERROR_PATH_UNSUPPORTED, "binding",
            fmt::format("{} has no {}", profile.path, path));
    require(
        find_input(profile, path, action->type), XR_ERROR_PATH_UNSUPPORTED, "binding",
        fmt::format("{} of {} cannot be converted to the type of the action '{}'", path, profile.path, action->name));
    if (!action->subaction_paths.empty()) {
        const auto& declared = action->subaction_paths;
        const bool is_below = std::any_of(declared.begin(), declared.end(),
                                          [&](XrPath user) { return path.starts_with(text_of(user) + '/'); });
        if (!is_below)
            warn("binding", fmt::format("{} lies below no subaction path of the action '{}'", path, action->name));
    }
    return {action, path};
}

XrResult suggest_bindings(XrInstance handle, const XrInteractionProfileSuggestedBinding* suggested) {
    Instance& instance = instance_of(handle);
    const XrInteractionProfileSuggestedBinding& info = checked(suggested);
    const std::string path = text_of(info.interactionProfile);
    require(info.countSuggestedBindings > 0, XR_ERROR_VALIDATION_FAILURE, "binding", "countSuggestedBindings is 0");
    check_pointer(info.suggestedBindings, "suggestedBindings");
    const Profile* profile = offered_profile(instance, path);
    std::vector<Binding> bindings;
    for (uint32_t i = 0; i < info.countSuggestedBindings; ++i)
        bindings.push_back(checked_binding(*profile, info.suggestedBindings[i]));
    const auto earlier = instance.suggested.find(path);
    const bool is_repeated =
        earlier != instance.suggested.end() && runtime().objects.contains(bits(earlier->second.front().action->handle));
    if (is_repeated) warn("binding", "the bindings for " + path + " are suggested a second time");

    auto& reported = runtime().report.bindings[path];
    reported.clear();
    for (const Binding& binding : bindings) reported.push_back({binding.action->name, binding.path});
    instance.suggested[path] = std::move(bindings);
    return XR_SUCCESS;
}

XrResult attach_action_sets(XrSession handle, const XrSessionActionSetsAttachInfo* attach_info) {
    Session& session = object<Session>(handle);
    const XrSessionActionSetsAttachInfo& info = checked(attach_info);
    require(info.countActionSets > 0, XR_ERROR_VALIDATION_FAILURE, "action-order", "countActionSets is 0");
    check_pointer(info.actionSets, "actionSets");
    require(!session.is_attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action-order",
            "xrAttachSessionActionSets is allowed once for a session");
    std::vector<std::shared_ptr<ActionSet>> sets;
    for (uint32_t i = 0; i < info.countActionSets; ++i) sets.push_back(shared<ActionSet>(info.actionSets[i]));
    session.is_attached = true;
    session.attached = sets;
    for (const auto& set : sets) set->is_attached = true;

    auto& names = runtime().report.actions;
    names.clear();
    for (const auto& action : all_of<Action>())
        if (action->set->is_attached) names.push_back(action->set->name + "/" + action->name);
    return XR_SUCCESS;
}

XrResult get_current_profile(XrSession handle, XrPath user_path, XrInteractionProfileState* out) {
    Session& session = object<Session>(handle);
    const std::string user = text_of(user_path);
    XrInteractionProfileState& state = checked(out);
    const bool is_user = user == "/user/hand/left" || user == "/user/hand/right" || user == "/user/head" ||
                         user == "/user/gamepad" || user == "/user/treadmill";
    require(is_user, XR_ERROR_PATH_UNSUPPORTED, "path", fmt::format("'{}' is no top level user path", user));
    require(session.is_attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "action-order",
            "xrGetCurrentInteractionProfile before xrAttachSessionActionSets");
    const bool has_controller = user.starts_with("/user/hand/") && !session.current_profile.empty();
    state.interactionProfile = has_controller ? path_of(session.current_profile) : XR_NULL_PATH;
    return XR_SUCCESS;
}

std::shared_ptr<Action> attached_action(const Session& session, XrAction handle) {
    const auto action = shared<Action>(handle);
    const auto& attached = session.attached;
    require(std::find(attached.begin(), attached.end(), action->set) != attached.end(), XR_ERROR_ACTIONSET_NOT_ATTACHED,
            "action-order", fmt::format("the action set of '{}' is not attached to the session", action->name));
    return action;
}

XrResult enumerate_sources(XrSession handle, const XrBoundSourcesForActionEnumerateInfo* enumerate_info,
                           uint32_t capacity, uint32_t* count, XrPath* out) {
    Session& session = object<Session>(handle);
    const auto action = attached_action(session, checked(enumerate_info).action);
    std::vector<XrPath> paths;
    for (const Source& source : sources_of(session, *action, XR_NULL_PATH)) paths.push_back(path_of(source.input));
    return give_values(capacity, count, out, paths);
}

std::string capitalised(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
    return text;
}

XrResult get_source_name(XrSession handle, const XrInputSourceLocalizedNameGetInfo* get_info, uint32_t capacity,
                         uint32_t* count, char* out) {
    Session& session = object<Session>(handle);
    const XrInputSourceLocalizedNameGetInfo& info = checked(get_info);
    const std::string path = text_of(info.sourcePath);
    require(info.whichComponents != 0 && (info.whichComponents & ~XrInputSourceLocalizedNameFlags{7}) == 0,
            XR_ERROR_VALIDATION_FAILURE, "flags", "whichComponents must have one of its three bits");
    require(session.is_attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "action-order",
            "xrGetInputSourceLocalizedName before xrAttachSessionActionSets");
    require(path.starts_with("/user/hand/"), XR_ERROR_PATH_UNSUPPORTED, "path",
            fmt::format("'{}' is no input source", path));
    std::vector<std::string> parts;
    if (info.whichComponents & XR_INPUT_SOURCE_LOCALIZED_NAME_USER_PATH_BIT)
        parts.push_back(path.starts_with("/user/hand/left") ? "Left Hand" : "Right Hand");
    const Profile* profile = find_profile(session.current_profile);
    if (profile && info.whichComponents & XR_INPUT_SOURCE_LOCALIZED_NAME_INTERACTION_PROFILE_BIT)
        parts.push_back(profile->name);
    const size_t input = path.find("put/");
    if (input != std::string::npos && info.whichComponents & XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT)
        parts.push_back(capitalised(path.substr(input + 4, path.find('/', input + 4) - input - 4)));
    return give_text(capacity, count, out, fmt::format("{}", fmt::join(parts, " ")));
}

}  // namespace

std::vector<Source> sources_of(const Session& session, const Action& action, XrPath subaction_path) {
    std::vector<Source> sources;
    const std::string below = subaction_path == XR_NULL_PATH ? "/user/" : text_of(subaction_path) + "/";
    for (const std::string& path : {session.current_profile, std::string(kTrackerProfile), std::string(kGazeProfile)}) {
        const Profile* profile = find_profile(path);
        const auto suggested = session.instance->suggested.find(path);
        if (!profile || suggested == session.instance->suggested.end()) continue;
        for (const Binding& binding : suggested->second) {
            if (binding.action->handle != action.handle || !binding.path.starts_with(below)) continue;
            const ProfileInput* input = find_input(*profile, binding.path, action.type);
            if (input) sources.push_back({binding.path, user_of(binding.path) + input->path});
        }
    }
    return sources;
}

std::string fitting_profile(const Instance& instance) {
    const std::string& own = runtime().progress.profile;
    if (own.empty()) return "";
    if (instance.suggested.contains(own)) return own;
    return instance.suggested.contains(kSimple) ? kSimple : "";
}

std::vector<EntryPoint> binding_entries() {
    return {NEUVV_XR_ENTRY(xrSuggestInteractionProfileBindings, suggest_bindings),
            NEUVV_XR_ENTRY(xrAttachSessionActionSets, attach_action_sets),
            NEUVV_XR_ENTRY(xrGetCurrentInteractionProfile, get_current_profile),
            NEUVV_XR_ENTRY(xrEnumerateBoundSourcesForAction, enumerate_sources),
            NEUVV_XR_ENTRY(xrGetInputSourceLocalizedName, get_source_name)};
}

}  // namespace neuvv::xr_runtime
