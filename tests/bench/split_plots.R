# Split plots by lme4, nlme and pbkrtest: variances, coefficients with Kenward and Roger's error and freedom, tests
# of the terms. Rscript split_plots.R FOLDER: reads FOLDER/plans.txt (file, factors in words, fixed part) and writes
# FOLDER/reference.csv.
suppressMessages({
  library(lme4)
  library(pbkrtest)
  library(nlme)
})
folder <- commandArgs(trailingOnly = TRUE)[1]
plans <- read.table(file.path(folder, "plans.txt"), sep = "\t", stringsAsFactors = FALSE)
out <- data.frame()
add <- function(plan, what, name, value) out <<- rbind(out, data.frame(plan, what, name, value = sprintf("%.15g", value)))
for (i in seq_len(nrow(plans))) {
  plan <- plans[i, 1]
  d <- read.csv(file.path(folder, plan), stringsAsFactors = TRUE)
  d$load <- factor(d$load)
  fixed <- as.formula(paste("y ~", plans[i, 2]))
  tight <- lmerControl(optimizer = "nloptwrap", optCtrl = list(xtol_abs = 1e-10, ftol_abs = 1e-14, maxeval = 1e5), check.conv.singular = "ignore",
                       check.conv.grad = "ignore", check.conv.hess = "ignore")
  m <- suppressMessages(lmer(update(fixed, . ~ . + (1 | load)), d, REML = TRUE, control = tight))
  v <- as.data.frame(VarCorr(m))
  if (v$vcov[1] < 1e-9 * v$vcov[2]) {
    # Whole plots scatter less than their runs say: lme4 holds the variance at 0, a correlation within plots may be negative.
    g <- try(gls(fixed, d, correlation = corCompSymm(form = ~ 1 | load), method = "REML",
                 control = glsControl(tolerance = 1e-10, msTol = 1e-12, maxIter = 500, msMaxIter = 500)), silent = TRUE)
    if (inherits(g, "try-error")) next
    rho <- as.numeric(coef(g$modelStruct$corStruct, unconstrained = FALSE))
    # The program stops where the means of the largest plots would count twenty times what their runs say.
    if (1 + max(table(d$load)) * rho / (1 - rho) < exp(-3)) next
    add(plan, "plot_variance", "", 0)
    add(plan, "run_variance", "", g$sigma^2 * (1 - rho))
    for (name in names(coef(g))) add(plan, "estimate", name, coef(g)[name])
    next
  }
  add(plan, "plot_variance", "", v$vcov[1])
  add(plan, "run_variance", "", v$vcov[2])
  n <- try(lme(fixed, d, random = ~ 1 | load, method = "REML"), silent = TRUE)
  if (!inherits(n, "try-error")) add(plan, "nlme_plot_sd", "", as.numeric(VarCorr(n)[1, 2]))
  V0 <- vcov(m)
  VA <- vcovAdj(m)
  b <- fixef(m)
  for (j in seq_along(b)) {
    L <- as.numeric(seq_along(b) == j)
    add(plan, "estimate", names(b)[j], b[j])
    add(plan, "standard_error", names(b)[j], sqrt(VA[j, j]))
    add(plan, "freedom", names(b)[j], Lb_ddf(L, V0, VA))
  }
  assign <- attr(model.matrix(m), "assign")
  for (t in seq_along(attr(terms(fixed), "term.labels"))) {
    L <- diag(length(b))[assign == t, , drop = FALSE]
    test <- KRmodcomp(m, L)$test["Ftest", ]
    name <- attr(terms(fixed), "term.labels")[t]
    add(plan, "term_f", name, test$stat)
    add(plan, "term_freedom", name, test$ddf)
    add(plan, "term_p", name, test$p.value)
  }
}
write.csv(out, file.path(folder, "reference.csv"), row.names = FALSE, quote = 3)
