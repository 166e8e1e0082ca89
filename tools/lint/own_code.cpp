// A plugin of clang-tidy 14: keeps all checks to declarations outside system headers, which halves the time of the
// lint. Without it, clang-tidy matches every check against the standard library and whatever else a file includes, and
// then drops what it found there. Lost are the few findings that compare own declarations with those of system headers,
// such as those of bugprone-forward-declaration-namespace. It also has checks of its own, which clang-tidy lacks.
// tools/check compiles and loads it.
#include <clang-tidy/ClangTidyCheck.h>
#include <clang-tidy/ClangTidyModule.h>
#include <clang-tidy/ClangTidyModuleRegistry.h>
#include <clang/AST/ASTContext.h>
#include <clang/ASTMatchers/ASTMatchFinder.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace {

// It matches the translation unit itself, which is visited first, and narrows what is visited after it.
class OwnCode : public clang::tidy::ClangTidyCheck {
  public:
    using ClangTidyCheck::ClangTidyCheck;
    void registerMatchers(clang::ast_matchers::MatchFinder* finder) override {
        finder->addMatcher(clang::ast_matchers::translationUnitDecl().bind("unit"), this);
    }
    void check(const clang::ast_matchers::MatchFinder::MatchResult& result) override {
        std::vector<clang::Decl*> own;
        for (clang::Decl* declaration : result.Context->getTranslationUnitDecl()->decls()) {
            const clang::SourceLocation at = declaration->getLocation();
            if (at.isValid() && !result.SourceManager->isInSystemHeader(at)) own.push_back(declaration);
        }
        result.Context->setTraversalScope(own);
    }
};

// Finds initialisers that call a member function of the object that is being made: such a function may read members
// that are made later. Functions of bases are complete by then, and a lambda is called later.
class CallInInitialiser : public clang::tidy::ClangTidyCheck {
  public:
    using ClangTidyCheck::ClangTidyCheck;
    void registerMatchers(clang::ast_matchers::MatchFinder* finder) override {
        using namespace clang::ast_matchers;
        const auto as_const = implicitCastExpr(hasCastKind(clang::CK_NoOp), has(cxxThisExpr()));
        const auto call = cxxMemberCallExpr(onImplicitObjectArgument(expr(anyOf(cxxThisExpr(), as_const))),
                                            unless(hasAncestor(lambdaExpr())))
                              .bind("call");
        const auto initialiser = expr(anyOf(call, forEachDescendant(call)));
        finder->addMatcher(cxxConstructorDecl(forEachConstructorInitializer(withInitializer(initialiser))), this);
        finder->addMatcher(fieldDecl(hasInClassInitializer(initialiser)), this);
    }
    void check(const clang::ast_matchers::MatchFinder::MatchResult& result) override {
        const auto* call = result.Nodes.getNodeAs<clang::CXXMemberCallExpr>("call");
        diag(call->getBeginLoc(), "%0 is called before all members are made; call it after construction")
            << call->getMethodDecl();
    }
};

// Finds functions of one name in the unnamed namespaces of two sources of a target that could take the same arguments.
// CMake compiles several sources as one file, where a call would silently choose the nearer of the two.
class OverloadOfAnotherSource : public clang::tidy::ClangTidyCheck {
  public:
    using ClangTidyCheck::ClangTidyCheck;
    void registerMatchers(clang::ast_matchers::MatchFinder* finder) override {
        using namespace clang::ast_matchers;
        finder->addMatcher(functionDecl(isDefinition(), unless(cxxMethodDecl())).bind("function"), this);
    }
    void check(const clang::ast_matchers::MatchFinder::MatchResult& result) override {
        const auto* function = result.Nodes.getNodeAs<clang::FunctionDecl>("function");
        if (!function->isInAnonymousNamespace() || function->isTemplateInstantiation()) return;
        const clang::SourceManager& sources = *result.SourceManager;
        std::vector<const clang::FunctionDecl*>& others = functions_[function->getQualifiedNameAsString()];
        for (const clang::FunctionDecl* other : others)
            if (sources.getFileID(other->getLocation()) != sources.getFileID(function->getLocation()) &&
                take_the_same(*function, *other))
                diag(function->getLocation(),
                     "%0 takes the arguments of a function in another source of this target; "
                     "rename one or share it")
                    << function;
        others.push_back(function);
    }

  private:
    static bool take_the_same(const clang::FunctionDecl& a, const clang::FunctionDecl& b) {
        const unsigned most = std::min(a.getNumParams(), b.getNumParams());
        if (most < a.getMinRequiredArguments() || most < b.getMinRequiredArguments()) return false;
        for (unsigned i = 0; i < most; ++i) {
            const clang::QualType one = plain_type(*a.getParamDecl(i)), two = plain_type(*b.getParamDecl(i));
            if (one != two && !(one->isArithmeticType() && two->isArithmeticType())) return false;
        }
        return true;
    }
    static clang::QualType plain_type(const clang::ParmVarDecl& parameter) {
        return parameter.getType().getNonReferenceType().getCanonicalType().getUnqualifiedType();
    }

    std::map<std::string, std::vector<const clang::FunctionDecl*>> functions_;
};

class Module : public clang::tidy::ClangTidyModule {
  public:
    void addCheckFactories(clang::tidy::ClangTidyCheckFactories& factories) override {
        factories.registerCheck<OwnCode>("neuvv-own-code");
        factories.registerCheck<CallInInitialiser>("neuvv-call-in-initialiser");
        factories.registerCheck<OverloadOfAnotherSource>("neuvv-overload-of-another-source");
    }
};

const clang::tidy::ClangTidyModuleRegistry::Add<Module> kModule("neuvv", "Checks of this project");

}  // namespace
