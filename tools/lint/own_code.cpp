// A plugin of clang-tidy 14: keeps all checks to declarations outside system headers, which halves the time of the
// lint. Without it, clang-tidy matches every check against the standard library and whatever else a file includes, and
// then drops what it found there. Lost are the few findings that compare own declarations with those of system headers,
// such as those of bugprone-forward-declaration-namespace. It also has a check of its own, which clang-tidy lacks.
// tools/check compiles and loads it.
#include <clang-tidy/ClangTidyCheck.h>
#include <clang-tidy/ClangTidyModule.h>
#include <clang-tidy/ClangTidyModuleRegistry.h>
#include <clang/AST/ASTContext.h>
#include <clang/ASTMatchers/ASTMatchFinder.h>

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

class Module : public clang::tidy::ClangTidyModule {
  public:
    void addCheckFactories(clang::tidy::ClangTidyCheckFactories& factories) override {
        factories.registerCheck<OwnCode>("neuvv-own-code");
        factories.registerCheck<CallInInitialiser>("neuvv-call-in-initialiser");
    }
};

const clang::tidy::ClangTidyModuleRegistry::Add<Module> kModule("neuvv", "Checks of this project");

}  // namespace
